#!/bin/sh
# An ensemble by HyperQueue: as many parts at a time as the workers of the allocation have room for.
#
#     hq server start &                                     # once, on the login node
#     hq alloc add slurm --time-limit 2h                    # workers, in jobs of Slurm; or `hq worker start` on each machine
#     sh hyperqueue.sh
#
set -eu
case=avalanche.toml
parts=64
folder=parts                        # on a file system that all workers see

# A task that dies with its worker is started again and goes on from what it kept.
hq submit --wait --array "1-$parts" --cpus 2 --crash-limit 5 \
    sh -c "exec granflow ensemble $case --part \$HQ_TASK_ID/$parts --out $folder --threads 2 --quiet"

granflow merge "$folder"/part-*-of-"$parts".bin --out ensemble
