//! What can be said about `[scheme]`, `[time]` and `[output]`.

use crate::fault::CaseError;
use crate::material::Friction;
use crate::slope::Slope;
use crate::{Case, Model, SchemeName};

impl Case {
    pub(super) fn check_scheme(&self) -> Result<(), CaseError> {
        let scheme = &self.scheme;
        if scheme.step.is_some() && scheme.courant.is_some() {
            return Err(self.fault(
                "scheme.courant",
                "both `step` and `courant` are given",
                "keep step for a fixed step, courant for an adaptive one",
            ));
        }
        self.positive("scheme.step", scheme.step)?;
        self.not_negative("scheme.film", scheme.film)?;
        self.positive("scheme.theta_exponent", scheme.theta_exponent)?;
        if scheme.theta_exponent.is_some() && scheme.name != SchemeName::Adaptive {
            return Err(self.fault(
                "scheme.theta_exponent",
                format!("`theta_exponent` has no meaning for {}", scheme.name.as_str()),
                "remove it, or use the scheme adaptive",
            ));
        }
        if let Some(courant) = scheme.courant {
            let limit = scheme.name.courant_limit();
            let allowed = format!("a number > 0 and <= {limit} for {}", scheme.name.as_str());
            self.number("scheme.courant", courant, |v| v > 0.0 && v <= limit, &allowed)?;
        }
        if scheme.name.verfahren().is_none() {
            return Ok(());
        }
        let name = scheme.name.as_str();
        let refuse = |key: &str, what: &str| {
            Err(self.fault(key, format!("{name} {what}"), "use the scheme balanced or balanced_2, which can"))
        };
        if self.terrain.is_some() {
            return refuse("scheme.name", "works on a [grid] only, not on terrain");
        }
        if !matches!(self.material().friction, Friction::Coulomb(_)) {
            return refuse(
                &format!("material.friction.{}", self.material().friction.name()),
                "knows Coulomb friction only",
            );
        }
        if matches!(self.material().slope, Some(Slope::Profile(_))) {
            return refuse("material.slope", "works on a constant slope only");
        }
        Ok(())
    }

    pub(super) fn check_time(&self) -> Result<(), CaseError> {
        let time = &self.time;
        if time.steps.is_none() && time.end.is_none() && time.until.is_none() && time.stop.is_none() {
            return Err(self.fault(
                "time",
                "nothing ends the run",
                match self.model {
                    Model::SavageHutter => {
                        "add steps = 1000, end = 10.0, until = \"rest\" or stop.kinetic_energy = 0.01"
                    }
                    Model::HadelerKuttler => "add steps = 1000, end = 10.0 or until = \"steady\"",
                },
            ));
        }
        if time.steps == Some(0) {
            return Err(self.source.fault("time.steps", "found 0, expected a whole number > 0"));
        }
        self.positive("time.end", time.end)?;
        self.positive("time.rest_speed", time.rest_speed)?;
        self.positive("time.steady_rate", time.steady_rate)?;
        if let Some(stop) = &time.stop {
            self.number(
                "time.stop.kinetic_energy",
                stop.kinetic_energy,
                |v| v > 0.0 && v < 1.0,
                "a share of the peak, between 0 and 1",
            )?;
        }
        if time.rest_speed.is_some() && time.until.is_none() {
            return Err(self.fault(
                "time.rest_speed",
                "`rest_speed` has no meaning without until = \"rest\"",
                "add until = \"rest\" or remove rest_speed",
            ));
        }
        for (key, given) in [("steady_rate", time.steady_rate.is_some()), ("method", time.method.is_some())] {
            if given && time.until.is_none() {
                return Err(self.fault(
                    &format!("time.{key}"),
                    format!("`{key}` has no meaning without until = \"steady\""),
                    &format!("add until = \"steady\" or remove {key}"),
                ));
            }
        }
        if time.until.is_some() && self.scheme.name.verfahren().is_some() && time.rest_speed.is_none() {
            let message = format!(
                "{} never reaches speed 0, so until = \"rest\" would never end",
                self.scheme.name.as_str()
            );
            return Err(self.fault(
                "time.until",
                message,
                "add rest_speed = 1e-12, or use the scheme balanced, which stops exactly",
            ));
        }
        Ok(())
    }

    pub(super) fn check_output(&self) -> Result<(), CaseError> {
        let output = &self.output;
        if output.every.is_some() && output.steps.is_some() {
            return Err(self.fault("output.steps", "both `every` and `steps` are given", "keep one of them"));
        }
        self.positive("output.every", output.every)?;
        if output.steps == Some(0) {
            return Err(self.source.fault("output.steps", "found 0, expected a whole number > 0"));
        }
        for (index, kind) in output.files.iter().flatten().enumerate() {
            let key = format!("output.files[{index}]");
            if kind.needs_terrain() && self.terrain.is_none() {
                return Err(self.fault(
                    &key,
                    format!("`{}` needs [terrain]", kind.as_str()),
                    "on a grid: netcdf, csv, vtk, figures, animation",
                ));
            }
        }
        Ok(())
    }
}
