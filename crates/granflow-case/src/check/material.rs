//! What can be said about `[material]`.

use crate::Case;
use crate::fault::CaseError;
use crate::material::Friction;
use crate::slope::Slope;

const RADIANS: &str = "a plain number is in radians: write \"18 deg\" for degrees";

impl Case {
    pub(super) fn check_material(&self) -> Result<(), CaseError> {
        let Some(material) = &self.material else { return Ok(()) };
        self.positive("material.epsilon", material.epsilon)?;
        self.positive("material.gravity", material.gravity)?;
        self.positive("material.density", material.density)?;
        self.not_negative("material.eta", material.eta)?;
        if self.terrain.is_some() && material.density.is_none() {
            return Err(self.fault(
                "material.density",
                "the key `density` is missing",
                "the pressure on terrain needs it: density = 200.0 (kg/m^3, dry snow), 1500.0 (debris)",
            ));
        }
        self.check_friction(&material.friction)?;
        self.check_slope()
    }

    fn check_friction(&self, law: &Friction) -> Result<(), CaseError> {
        let at = format!("material.friction.{}", law.name());
        let key = |name: &str| format!("{at}.{name}");
        match law.written() {
            (Some(_), Some(_)) => {
                let cure = format!(
                    "keep one of angle and mu = tan(angle); with --set replace the table: --set 'material.friction={{{}={{mu=0.3}}}}'",
                    law.name()
                );
                return Err(self.fault(&key("mu"), "both `angle` and `mu` are given", &cure));
            }
            (None, None) => {
                return Err(self.fault(
                    &at,
                    "neither `angle` nor `mu` is given",
                    "add angle = \"25 deg\" or mu = 0.4",
                ));
            }
            (Some(angle), None) => {
                let fits = |v: f64| (0.0..std::f64::consts::FRAC_PI_2).contains(&v);
                self.number(
                    &key("angle"),
                    angle.radians(),
                    fits,
                    "an angle from 0 to below 90 deg (1.5708 rad)",
                )
                .map_err(|error| error.help(RADIANS))?;
            }
            (None, mu) => self.not_negative(&key("mu"), mu)?,
        }
        match law {
            Friction::Coulomb(_) => Ok(()),
            Friction::Voellmy(law) => self.positive(&key("xi"), Some(law.xi)),
            Friction::Cohesion(law) => self.not_negative(&key("tau0"), Some(law.tau0)),
            Friction::Samosat(law) => {
                self.not_negative(&key("tau0"), Some(law.tau0))?;
                self.not_negative(&key("rs0"), Some(law.rs0))?;
                self.positive(&key("kappa"), Some(law.kappa))?;
                self.positive(&key("r"), Some(law.r))?;
                self.positive(&key("b"), Some(law.b))
            }
        }
    }

    fn check_slope(&self) -> Result<(), CaseError> {
        let fits = |v: f64| v.abs() < std::f64::consts::FRAC_PI_2;
        let steep = |key: &str, value: f64| {
            self.number(key, value, fits, "an angle between -90 deg and 90 deg (1.5708 rad)")
                .map_err(|error| error.help(RADIANS))
        };
        match &self.material().slope {
            None => return Ok(()),
            Some(Slope::Constant(angle)) => return steep("material.slope", angle.radians()),
            Some(Slope::Profile(profile)) => {
                for (index, angle) in profile.angle.iter().flatten().enumerate() {
                    steep(&format!("material.slope.angle[{index}]"), angle.radians())?;
                }
                for (index, x) in profile.x.iter().flatten().enumerate() {
                    self.number(&format!("material.slope.x[{index}]"), *x, |_| true, "a finite number")?;
                }
            }
        }
        let chute = self.chute()?;
        let Some(grid) = &self.grid else { return Ok(()) };
        for cell in 0..grid.x.cells {
            let (x, low, high) = (grid.x.centre(cell), grid.x.face(cell), grid.x.face(cell + 1));
            let (zeta, kappa) = (chute.zeta(x), chute.kappa(low, high));
            if !fits(zeta) || !kappa.is_finite() {
                let message = format!("at x = {x} the slope is {zeta} rad and its curvature {kappa}");
                return Err(self.fault(
                    "material.slope",
                    message,
                    "expected an angle between -90 deg and 90 deg and a finite curvature",
                ));
            }
        }
        Ok(())
    }
}
