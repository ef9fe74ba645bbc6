//! `granflow ensemble` and `merge` as a user meets them: files, exit statuses, what is said.

mod support;

use std::fs;
use std::path::Path;
use support::{granflow, said, told};

const SLAB: &str = r#"title = "A slab"
[grid]
x = { from = -1.0, to = 3.0, cells = 100 }
[material]
epsilon = 1e-4
friction.coulomb = { mu = 0.3 }
[initial]
thickness.steps = { at = [-0.5, 0.0], values = [0.0, 1.0, 0.0] }
velocity_x = 1.0
[time]
until = "rest"
end = 12.0
[ensemble]
members = 12
vary."material.friction.coulomb.mu" = { uniform = [0.25, 0.4] }
exceed.peak_thickness = [0.5]
percentiles = [50]
"#;

fn slab(text: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("slab.toml"), text).unwrap();
    folder
}

/// It fails with this status and says all of that.
#[track_caller]
fn refused(folder: &Path, arguments: &[&str], status: i32, parts: &[&str]) {
    let output = granflow(folder, arguments);
    let told = told(&output);
    assert_eq!(output.status.code(), Some(status), "{told}");
    for part in parts {
        assert!(told.contains(part), "{part}: {told}");
    }
}

#[test]
fn one_command_gives_maps_tables_and_figures() {
    let folder = slab(SLAB);
    let check = granflow(folder.path(), &["check", "slab.toml"]);
    assert!(
        said(&check).contains("12 members, a Sobol sequence, seed 0: material.friction.coulomb.mu"),
        "{}",
        said(&check)
    );
    let output = granflow(folder.path(), &["ensemble", "slab.toml", "--keep-members", "--threads", "2"]);
    assert!(output.status.success(), "{}", told(&output));
    assert!(said(&output).starts_with("12 members computed, 0 failed: ensemble ("), "{}", said(&output));
    for name in [
        "members.csv",
        "members.nc",
        "result.nc",
        "ensemble.json",
        "figures/exceedance_peak_thickness_0_5.png",
        "members/000011.nc",
    ] {
        assert!(folder.path().join("ensemble").join(name).is_file(), "{name}");
    }
    let table = fs::read_to_string(folder.path().join("ensemble/members.csv")).unwrap();
    assert_eq!(table.lines().count(), 13);
    assert!(table.starts_with("member,status,material.friction.coulomb.mu,cells,steps,time,"), "{table}");
    // The same command finds all done; a run of the case itself moves the ensemble aside.
    let again = granflow(folder.path(), &["ensemble", "slab.toml"]);
    assert!(told(&again).contains("12 of 12 members"), "{}", told(&again));
    let run = granflow(folder.path(), &["run", "slab.toml", "--out", "ensemble"]);
    assert!(run.status.success() && told(&run).contains("previous"), "{}", told(&run));
    assert!(folder.path().join("ensemble/previous/members.csv").exists());
    assert!(!folder.path().join("ensemble/members.csv").exists());
}

#[test]
fn parts_of_any_order_are_the_whole() {
    let folder = slab(SLAB);
    let at = |name: &str| folder.path().join(name);
    let whole = granflow(folder.path(), &["ensemble", "slab.toml", "--out", "whole", "-q"]);
    assert!(whole.status.success() && told(&whole).is_empty(), "{}", told(&whole));
    for part in ["2/5", "1/5", "5/5", "4/5", "3/5"] {
        let output = granflow(folder.path(), &["ensemble", "slab.toml", "--part", part, "-q"]);
        assert!(output.status.success(), "{}", told(&output));
    }
    let part = |k: u32| format!("ensemble/part-{k}-of-5.bin");
    let [one, two, three, four, five] = [1, 2, 3, 4, 5].map(part);
    let merge = |parts: &[&str], out: &str| {
        let mut arguments = vec!["merge"];
        arguments.extend(parts);
        arguments.extend(["--out", out]);
        granflow(folder.path(), &arguments)
    };
    let output = merge(&[&four, &one, &five, &three, &two], "merged");
    assert!(output.status.success(), "{}", told(&output));
    for name in ["members.csv", "ensemble.json", "checkpoint/ensemble.bin", "figures/mean_peak_speed.png"] {
        let [whole, merged] = ["whole", "merged"].map(|out| fs::read(at(out).join(name)).unwrap());
        assert!(whole == merged, "{name}");
    }
    // A part that is not as it was left is named, and computed again.
    let sound = fs::read(at(&one)).unwrap();
    for damaged in [&sound[..sound.len() / 2], &fs::read(at(&two)).unwrap(), b""] {
        fs::write(at(&one), damaged).unwrap();
        let output = granflow(folder.path(), &["ensemble", "slab.toml", "--part", "1/5"]);
        assert!(output.status.success() && fs::read(at(&one)).unwrap() == sound, "{}", told(&output));
        assert!(
            told(&output).contains("part-1-of-5.bin") && told(&output).contains("again"),
            "{}",
            told(&output)
        );
    }
    let told_of = |parts: &[&str]| {
        let output = merge(parts, "no");
        assert_eq!(output.status.code(), Some(2), "{}", told(&output));
        told(&output)
    };
    assert!(told_of(&[&one, &two, &two, &three, &four, &five]).contains("member 2 is in"));
    let missing = told_of(&[&one, &two, &four, &five]);
    assert!(missing.contains("members are in no part: 4..7;"), "{missing}");
    assert!(!at("no").exists(), "nothing of a merge that was refused");
    // A part knows its case: it is used without the file, and after that was edited.
    fs::write(at("slab.toml"), SLAB.replace("seed", "# seed").replace("A slab", "Another slab")).unwrap();
    let output = merge(&[&five, &four, &three, &two, &one], "later");
    assert!(output.status.success(), "{}", told(&output));
    let other = granflow(folder.path(), &["ensemble", "slab.toml", "--part", "1/5", "--out", "other", "-q"]);
    assert!(other.status.success(), "{}", told(&other));
    refused(folder.path(), &["merge", &two, "other/part-1-of-5.bin"], 4, &["another case", "--set"]);
    refused(folder.path(), &["merge", "slab.toml"], 4, &["no part of an ensemble"]);
    refused(folder.path(), &["merge"], 2, &["<PART>"]);
}

#[test]
fn parts_whose_files_have_moved_say_how_they_are_found() {
    let read = "thickness = { file = \"start.csv\" }";
    let folder =
        slab(&SLAB.replace("thickness.steps = { at = [-0.5, 0.0], values = [0.0, 1.0, 0.0] }", read));
    let at = |name: &str| folder.path().join(name);
    let start: Vec<String> = (0..100).map(|cell| if cell < 20 { "1.0" } else { "0.0" }.to_owned()).collect();
    fs::write(at("start.csv"), start.join(",")).unwrap();
    let part = granflow(folder.path(), &["ensemble", "slab.toml", "--part", "1/1", "--out", "parts", "-q"]);
    assert!(part.status.success(), "{}", told(&part));
    fs::create_dir(at("moved")).unwrap();
    for name in ["slab.toml", "start.csv"] {
        fs::rename(at(name), at("moved").join(name)).unwrap();
    }
    let merge = ["merge", "parts/part-1-of-1.bin", "--out", "whole"];
    let output = granflow(folder.path(), &merge);
    assert!(!output.status.success() && told(&output).contains("--case CASE.toml"), "{}", told(&output));
    let found = granflow(folder.path(), &[merge.as_slice(), &["--case", "moved/slab.toml"]].concat());
    assert!(found.status.success() && at("whole/result.nc").exists(), "{}", told(&found));
}

#[test]
fn what_makes_no_sense_is_refused_with_the_cure() {
    let folder = slab(SLAB);
    let plain = SLAB.split("[ensemble]").next().unwrap();
    fs::write(folder.path().join("plain.toml"), plain).unwrap();
    refused(folder.path(), &["ensemble", "plain.toml"], 2, &["no table [ensemble]", "docs/ensemble.md"]);
    refused(folder.path(), &["ensemble", "slab.toml", "--members", "0..13"], 2, &["the case has 12 members"]);
    refused(folder.path(), &["ensemble", "slab.toml", "--members", "4..4"], 2, &["200..400"]);
    refused(folder.path(), &["ensemble", "slab.toml", "--part", "0/4"], 2, &["3/16"]);
    refused(folder.path(), &["ensemble", "slab.toml", "--part", "1/13"], 2, &["at most as many parts"]);
    refused(folder.path(), &["ensemble", "slab.toml", "--set", "ensemble.members=0"], 2, &["expected 1 to"]);
    let vary = r#"ensemble.vary={"material.friction.coulomb.mu"={normal={mean=0.1,sd=0.1}}}"#;
    refused(folder.path(), &["ensemble", "slab.toml", "--set", vary], 2, &["does not take", "min and max"]);
    assert!(!folder.path().join("ensemble").exists(), "nothing was begun");
    let pile = "model = \"hadeler_kuttler\"\n[grid]\nx = { from = 0, to = 1, cells = 10 }\n[time]\nend = 1\n[ensemble]\nmembers = 2\n";
    fs::write(folder.path().join("pile.toml"), pile).unwrap();
    refused(folder.path(), &["ensemble", "pile.toml"], 2, &["`ensemble` belongs to the model savage_hutter"]);
}

#[test]
fn members_that_fail_are_named_and_all_of_them_are_exit_3() {
    let failing = SLAB.replace("[time]", "[scheme]\nname = \"verfahren_1\"\nstep = 0.001\n[time]").replace(
        "vary.\"material.friction.coulomb.mu\" = { uniform = [0.25, 0.4] }",
        "vary.\"scheme.step\" = { choice = [0.001, 0.5] }",
    );
    let folder = slab(&failing.replace("until = \"rest\"\nend = 12.0", "end = 1.0"));
    let output = granflow(folder.path(), &["ensemble", "slab.toml"]);
    let told = told(&output);
    assert!(output.status.success(), "{told}");
    assert!(
        told.contains("(seed 0, scheme.step=0.5) failed:") && said(&output).contains(" failed: ensemble"),
        "{told}"
    );
    let set = "ensemble.vary={\"scheme.step\"={choice=[0.4,0.5]}}";
    refused(
        folder.path(),
        &["ensemble", "slab.toml", "--set", set, "--out", "all"],
        3,
        &["all 12 members failed"],
    );
    assert!(folder.path().join("all/members.csv").exists());
}

#[cfg(unix)]
#[test]
fn a_signal_keeps_what_is_done_and_the_same_command_goes_on() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};
    let folder = slab(&SLAB.replace("members = 12", "members = 60").replace("cells = 100", "cells = 4000"));
    let arguments = ["ensemble", "slab.toml", "--threads", "1"];
    let mut running = Command::new(support::PROGRAM)
        .current_dir(folder.path())
        .args(arguments)
        .stderr(Stdio::null())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(1500));
    // SAFETY: the process is our own child, and has not been waited for.
    unsafe { libc::kill(running.id() as i32, libc::SIGINT) };
    let begun = Instant::now();
    let status = running.wait().unwrap();
    assert!(begun.elapsed() < Duration::from_secs(30));
    if status.code() == Some(0) {
        return; // a fast machine had done all
    }
    assert_eq!(status.code(), Some(130));
    assert!(folder.path().join("ensemble/checkpoint/ensemble.bin").exists());
    assert!(!folder.path().join("ensemble/result.nc").exists());
    let output = granflow(folder.path(), &["ensemble", "slab.toml", "--resume"]);
    assert!(output.status.success(), "{}", told(&output));
    assert!(!told(&output).starts_with("0 of 60"), "{}", told(&output));
    assert!(said(&output).starts_with("60 members computed"), "{}", said(&output));
}
