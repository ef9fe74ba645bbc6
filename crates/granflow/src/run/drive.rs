//! The loop: steps until one of a run's ends is reached, sinks looking on.

use super::{Broken, Ends, Failure, Run, Sink, SinkError, StopReason, Until, law, trickle};

/// Why a run did not reach an end.
#[derive(Debug, thiserror::Error)]
pub enum DriveError {
    /// A step could not be taken; it began at time `time`.
    #[error("{failure}")]
    Step {
        /// Why.
        failure: Failure,
        /// Time at its begin.
        time: f64,
    },
    /// A state breaks a law of its own, at the start, in a frame or at the end.
    #[error(transparent)]
    Law(#[from] Broken),
    /// A sink could not take what it was shown.
    #[error(transparent)]
    Sink(SinkError),
}

impl From<SinkError> for DriveError {
    /// A law that a sink found broken is a broken law.
    fn from(error: SinkError) -> Self {
        match error.0.downcast() {
            Ok(broken) => Self::Law(*broken),
            Err(other) => Self::Sink(SinkError(other)),
        }
    }
}

/// Step `run` to the first of its `ends`, or until a sink asks for the end, which it may between two instants of one step too;
/// then no sink hears of that step. No step is cut at an instant that a sink waits
/// for: the sink is shown the state there on the straight line between the begin and the end of the step that passes it
/// ([`Stepper::show`](super::Stepper::show)). So what is written changes nothing of what is computed.
///
/// State and maps must keep the laws of the run at the start and at the end; of a frame its sink sees to that.
///
/// # Errors
/// [`DriveError`]: the sinks have seen every step before.
pub fn drive(run: &mut dyn Run, ends: &Ends, sinks: &mut [&mut dyn Sink]) -> Result<StopReason, DriveError> {
    run.stepper_mut().show_end();
    watch_for(run, ends);
    run.bring();
    law::check_state(run)?;
    let reason = steps(run, ends, sinks)?;
    law::check_end(run)?;
    Ok(reason)
}

/// Have the run keep what [`reached`] asks of it.
pub fn watch_for(run: &mut dyn Run, ends: &Ends) {
    if ends.kinetic_energy.is_some() {
        run.track_energy();
    }
    if let Some(Until::Rest { trickle: Some(thickness), .. }) = ends.until {
        run.track_trickle(thickness);
    }
}

/// The steps to the first of the ends.
fn steps(run: &mut dyn Run, ends: &Ends, sinks: &mut [&mut dyn Sink]) -> Result<StopReason, DriveError> {
    let last = ends.time.unwrap_or(f64::INFINITY);
    loop {
        if wants_end(sinks) {
            return Ok(StopReason::Interrupted);
        }
        if let Some(reason) = reached(run, ends) {
            return Ok(reason);
        }
        run.stepper_mut().expect(next_instant(sinks));
        let time = run.time();
        let dt = run.step(last).map_err(|failure| failed(run, failure, time))?;
        if dt.is_infinite() {
            return Ok(StopReason::AtRest);
        }
        if !show_instants(run, sinks, time)? {
            return Ok(StopReason::Interrupted);
        }
        for sink in sinks.iter_mut() {
            sink.after_step(run)?;
        }
    }
}

/// Why a step that began at `time` failed; of a state that is not finite the cell is named.
fn failed(run: &mut dyn Run, failure: Failure, time: f64) -> DriveError {
    match (failure, law::check_state(run)) {
        (Failure::NotFinite { .. }, Err(broken)) => DriveError::Law(broken),
        _ => DriveError::Step { failure, time },
    }
}

fn wants_end(sinks: &[&mut dyn Sink]) -> bool {
    sinks.iter().any(|sink| sink.wants_end())
}

/// The first instant that a sink waits for.
fn next_instant(sinks: &[&mut dyn Sink]) -> f64 {
    sinks.iter().map(|sink| sink.next_instant()).fold(f64::INFINITY, f64::min)
}

/// An instant this share of a step before or after its end is that end: times of steps are sums.
const ROUNDING: f64 = 1e-9;

/// Show the sinks the instants that the last step, from time `begin` on, passed, in their order. Of one that had passed before
/// (somebody else stepped the run) they see the end of the step. False where a sink asked for the end before the last of them.
fn show_instants(run: &mut dyn Run, sinks: &mut [&mut dyn Sink], begin: f64) -> Result<bool, SinkError> {
    let end = run.time();
    let near = ROUNDING * (end - begin);
    let (mut first, mut brought) = (true, false);
    loop {
        let instant = next_instant(sinks);
        let all = instant > end + near;
        if all || (!first && wants_end(sinks)) {
            run.stepper_mut().show_end();
            run.bring();
            return Ok(all);
        }
        first = false;
        let at_end = instant < begin || end - instant <= near;
        run.stepper_mut().show(if at_end { end } else { instant });
        if at_end && !std::mem::replace(&mut brought, true) {
            // At the end of the step what comes then is there; within it, it was not.
            run.bring();
        }
        for sink in sinks.iter_mut().filter(|sink| sink.next_instant() == instant) {
            sink.at_instant(run)?;
            assert!(sink.next_instant() > instant, "a sink waits again for an instant that it was shown");
        }
    }
}

/// Why a run is over by its ends, if it is.
pub fn reached(run: &dyn Run, ends: &Ends) -> Option<StopReason> {
    let record = run.record();
    match ends.until {
        Some(Until::Rest { .. }) if !run.is_settled() => {}
        Some(Until::Rest { .. }) if run.at_rest() => return Some(StopReason::AtRest),
        Some(Until::Rest { speed: Some(limit), .. }) if run.steps() > 1 && run.stepper().speed() < limit => {
            return Some(StopReason::BelowSpeed);
        }
        Some(Until::Rest { trickle: Some(_), .. }) if trickle::is_all(run) => {
            return Some(StopReason::Trickle);
        }
        Some(Until::Steady { rate }) if run.is_steady(rate) => return Some(StopReason::Steady),
        Some(Until::Equilibrium) if run.is_equilibrium() => return Some(StopReason::Steady),
        _ => {}
    }
    let calm = |share: f64| record.peak_energy > 0.0 && record.energy < share * record.peak_energy;
    if run.steps() > 0 && ends.kinetic_energy.is_some_and(calm) {
        return Some(StopReason::KineticEnergy);
    }
    if ends.time.is_some_and(|last| run.time() >= last) {
        return Some(StopReason::EndTime);
    }
    ends.steps.is_some_and(|steps| run.steps() >= steps).then_some(StopReason::Steps)
}
