//! An ensemble in a folder: what is done is kept there, and the same command goes on from it.

use super::workers::Progress;
use super::{Ensemble, EnsembleError, Outcome, Reduced};
use crate::output::Error;
use crate::output::folder::Folder;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// Where what is done is kept.
const KEPT: &str = "checkpoint/ensemble.bin";

/// What is not in the case: where, which members, on how many cores.
#[derive(Debug, Clone)]
pub struct Options {
    /// Folder of the results.
    pub directory: PathBuf,
    /// The members that are wanted.
    pub members: Range<u32>,
    /// Members computed at a time; 0 takes all cores.
    pub workers: usize,
    /// Go on from what is in the folder; what cannot be gone on from is an error then.
    pub resume: bool,
    /// Write the maps of each member too.
    pub keep_members: bool,
    /// The command, for the history of the results.
    pub command: String,
    /// Hears what happened to earlier files, and what warns.
    pub notice: fn(&str),
}

/// What was computed into a folder.
#[derive(Debug)]
pub struct Done {
    /// All members that the folder has.
    pub reduced: Reduced,
    /// How many of the wanted members are missing: it was interrupted.
    pub missing: usize,
    /// Seconds in the steps of the members that were computed now, summed.
    pub stepping_seconds: f64,
    /// The files that were written.
    pub files: Vec<PathBuf>,
    _folder: Folder,
}

impl Ensemble {
    /// Computes members into a folder: what is there of the same case counts, what is done is kept every 20 seconds and when `stop` is set.
    /// Once all members that are wanted are there, maps and tables of all that the folder has are written.
    ///
    /// # Errors
    /// [`EnsembleError`]; what was kept stays.
    pub fn into_folder(
        &self,
        options: &Options,
        stop: &AtomicBool,
        hear: &mut (dyn FnMut(Progress) + Send),
    ) -> Result<Done, EnsembleError> {
        let folder = Folder::take(&options.directory)?;
        let begun = self.begin(&folder, options)?;
        folder.sweep()?;
        let path = folder.path().join(KEPT);
        let mut stepping_seconds = 0.0;
        let mut unwritten = None;
        let mut listen = |progress: Progress, outcome: Option<&Outcome>| {
            stepping_seconds = progress.stepping_seconds;
            if let (true, Some(outcome)) = (options.keep_members, outcome)
                && let Err(error) = self.write_member(outcome, folder.path())
            {
                unwritten.get_or_insert(error);
            }
            hear(progress);
        };
        let keep = |reduced: &Reduced| self.write(reduced, &path);
        let members = options.members.clone();
        let before = members.clone().filter(|number| begun.has(*number)).count();
        if options.keep_members && before > 0 {
            let text = format!(
                "{before} members were computed before; only those computed now are kept one by one (another --out computes all)"
            );
            (options.notice)(&text);
        }
        let reduced = self.run(members.clone(), begun, options.workers, stop, &keep, &mut listen)?;
        if let Some(error) = unwritten {
            return Err(error);
        }
        let missing = members.filter(|number| !reduced.has(*number)).count();
        let files = match missing {
            0 => self.write_files(&reduced, folder.path(), &options.command)?,
            _ => Vec::new(),
        };
        Ok(Done { reduced, missing, stepping_seconds, files, _folder: folder })
    }

    /// What the folder has of this ensemble; other files are moved aside.
    fn begin(&self, folder: &Folder, options: &Options) -> Result<Reduced, EnsembleError> {
        let path = folder.path().join(KEPT);
        let found = if path.exists() { Some(self.read(&path)) } else { None };
        match found {
            Some(Ok(reduced)) => return Ok(reduced),
            Some(Err(error)) if options.resume => return Err(error),
            None if options.resume && folder.is_taken() => {
                let problem = "it has the files of a run, and no ensemble to go on with; name another folder with --out, or leave --resume out: what is here then goes into previous/";
                return Err(Error::mismatch(folder.path(), problem).into());
            }
            Some(Err(error)) => (options.notice)(&format!("nothing of the folder is taken: {error}")),
            None => {}
        }
        if let Some(moved) = folder.clear()? {
            (options.notice)(&moved.to_string());
        }
        Ok(self.empty())
    }

    /// Computes the members of part `number` of `count` (from 1) and writes them as one file into a folder, which parts may share; what an
    /// interrupted one left there is gone on from. Nothing where `stop` was set before all were done.
    ///
    /// # Errors
    /// [`EnsembleError`].
    pub fn into_part(
        &self,
        [number, count]: [u32; 2],
        options: &Options,
        stop: &AtomicBool,
        hear: &mut (dyn FnMut(Progress) + Send),
    ) -> Result<Option<PathBuf>, EnsembleError> {
        let members = self.members_of_part([number, count]);
        let name = format!("part-{number}-of-{count}");
        let [path, under_way] =
            ["bin", "begun"].map(|ending| options.directory.join(format!("{name}.{ending}")));
        let taken = |path: &PathBuf| match self.read(path) {
            Ok(reduced) if reduced.members().all(|number| members.contains(&number)) => Some(reduced),
            other => {
                let another = || format!("{}: it is another part", path.display());
                let why = other.err().map_or_else(another, |error| error.to_string());
                (options.notice)(&format!("{why}; this one is computed again"));
                None
            }
        };
        let begun = [&path, &under_way].into_iter().filter(|path| path.exists()).find_map(taken);
        let keep = |reduced: &Reduced| self.write(reduced, &under_way);
        let begun = begun.unwrap_or_else(|| self.empty());
        let mut listen = |progress: Progress, _: Option<&Outcome>| hear(progress);
        let reduced = self.run(members.clone(), begun, options.workers, stop, &keep, &mut listen)?;
        if !members.clone().all(|number| reduced.has(number)) {
            return Ok(None);
        }
        self.write(&reduced, &path)?;
        crate::output::remove_if_there(&under_way)?;
        Ok(Some(path))
    }

    /// The members of part `number` of `count`, from 1.
    ///
    /// # Panics
    /// If there is no such part.
    #[must_use]
    pub fn members_of_part(&self, [number, count]: [u32; 2]) -> Range<u32> {
        assert!(0 < number && number <= count, "part {number} of {count}");
        let begin = |part: u32| (u64::from(self.plan().members) * u64::from(part) / u64::from(count)) as u32;
        begin(number - 1)..begin(number)
    }

    /// Puts parts together, and writes maps and tables into a folder as if all members had been computed there.
    ///
    /// # Errors
    /// [`EnsembleError::Parts`] for a member that is in two of them or in none; [`EnsembleError::Output`] for what is no part of this
    /// ensemble.
    pub fn merge(&self, parts: &[PathBuf], options: &Options) -> Result<Done, EnsembleError> {
        let mut reduced = self.empty();
        for (k, path) in parts.iter().enumerate() {
            let part = self.read(path)?;
            if let Err(twice) = reduced.merge(part) {
                let other = parts[..k].iter().find(|path| self.read(path).is_ok_and(|part| part.has(twice)));
                let [one, two] = [other.unwrap_or(path), path].map(|path| path.display());
                let problem = format!("member {twice} is in {one} and in {two}: give each part once");
                return Err(EnsembleError::Parts(problem));
            }
        }
        let missing: Vec<u32> = (0..self.plan().members).filter(|number| !reduced.has(*number)).collect();
        if !missing.is_empty() {
            return Err(EnsembleError::Parts(lacking(&missing)));
        }
        let folder = Folder::take(&options.directory)?;
        if let Some(moved) = folder.clear()? {
            (options.notice)(&moved.to_string());
        }
        self.write(&reduced, &folder.path().join(KEPT))?;
        let files = self.write_files(&reduced, folder.path(), &options.command)?;
        Ok(Done { reduced, missing: 0, stepping_seconds: 0.0, files, _folder: folder })
    }
}

/// Which members are missing, in ranges as a command line takes them.
fn lacking(missing: &[u32]) -> String {
    let mut ranges: Vec<Range<u32>> = Vec::new();
    for number in missing {
        match ranges.last_mut() {
            Some(last) if last.end == *number => last.end += 1,
            _ => ranges.push(*number..number + 1),
        }
    }
    let count = missing.len();
    let shown: Vec<String> =
        ranges.iter().take(8).map(|range| format!("{}..{}", range.start, range.end)).collect();
    let more = if ranges.len() > 8 { " and more" } else { "" };
    format!(
        "{count} members are in no part: {}{more}; compute the parts that have them, and give all parts",
        shown.join(", ")
    )
}

/// The error of a folder for which no such path could be made.
pub(super) fn unmade(path: &Path) -> impl FnOnce(std::io::Error) -> EnsembleError {
    let path = path.to_owned();
    move |source| EnsembleError::Output(Error::Io { path, action: "make the folder", source })
}
