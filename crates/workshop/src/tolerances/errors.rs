//! How far off each design parameter may be made.

use hwasp_core::{DesignSpace, Dimension, parse_quantity};
use hwasp_settings::nearest;
use thiserror::Error;

use super::list::readable;

/// The error of a parameter that nothing is said of.
const ANY: &str = "5 %";

/// The manufacturing error of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct ManufacturingError {
    /// To either side, SI.
    pub size: f64,
    /// As it was given: `5 %`, `0.1 mm`.
    pub text: String,
}

/// Why an error cannot be had.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("--error {given}: {message}\n  = hint: {hint}")]
pub struct ManufacturingErrorFault {
    given: String,
    message: String,
    hint: String,
}

/// An error for each parameter of a `design` (SI), in its order. Of the `given` ones, `radius=0.1 mm`, one that names a
/// parameter goes before one that names its group, that before one for all of a quantity, and a later one before an earlier.
/// Where none of them names a parameter, those that are `common` for the mechanism count, by the same names.
pub fn manufacturing_errors(
    space: &DesignSpace,
    design: &[f64],
    common: &[(String, String)],
    given: &[String],
) -> Result<Vec<ManufacturingError>, ManufacturingErrorFault> {
    let parameters = parameters(space);
    let given = given.iter().map(|given| assignment(given, &parameters)).collect::<Result<Vec<_>, _>>()?;
    let common = common.iter().map(|(key, value)| Assignment { given: format!("{key}={value}"), key, value });
    let any = |parameter: &Parameter| Assignment { given: format!("{}={ANY}", parameter.name), key: "", value: ANY };
    parameters
        .iter()
        .zip(design)
        .map(|(parameter, &nominal)| {
            let chosen = (given.iter().filter_map(|a| Some((parameter.rank(a.key)?, a.clone()))))
                // The last of the greatest.
                .max_by_key(|(rank, _)| *rank)
                .map(|(_, assignment)| assignment);
            let chosen = chosen.or_else(|| common.clone().find(|a| parameter.rank(a.key).is_some()));
            chosen.unwrap_or_else(|| any(parameter)).size(parameter, nominal)
        })
        .collect()
}

/// `radius=0.1 mm`, taken apart.
#[derive(Clone, Debug)]
struct Assignment<'a> {
    given: String,
    key: &'a str,
    value: &'a str,
}

fn assignment<'a>(given: &'a str, parameters: &[Parameter]) -> Result<Assignment<'a>, ManufacturingErrorFault> {
    let fault = |message: String, hint: String| ManufacturingErrorFault { given: given.to_owned(), message, hint };
    let (key, value) = given.split_once('=').ok_or_else(|| {
        fault("it has no `=`".into(), format!("write it as NAME=SIZE, {}=\"5 %\" for example", parameters[0].group))
    })?;
    let (key, value) = (key.trim(), value.trim().trim_matches('"'));
    if !parameters.iter().any(|parameter| parameter.rank(key).is_some()) {
        let mut names: Vec<&str> = Vec::new();
        for name in parameters.iter().flat_map(|p| [p.quantity.as_str(), p.group.as_str()]) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let near = nearest(key, names.iter().copied());
        let hint = near.map_or(format!("there are {}", names.join(", ")), |near| format!("did you mean `{near}`?"));
        return Err(fault(format!("`{key}` is no parameter of this design"), hint));
    }
    Ok(Assignment { given: given.to_owned(), key, value })
}

/// What a parameter can be called.
struct Parameter {
    /// `stiffness[3]`, `thumb_distal_radius`.
    name: String,
    /// `stiffness`, `thumb_distal_radius`.
    group: String,
    /// The last word of the group: `stiffness`, `radius`.
    quantity: String,
    dimension: Dimension,
}

fn parameters(space: &DesignSpace) -> Vec<Parameter> {
    let groups = space.groups().iter().flat_map(|group| std::iter::repeat_n(group, group.count));
    let parameter = |(name, group): (String, &hwasp_core::DesignGroup)| Parameter {
        name,
        group: group.name.clone(),
        quantity: group.name.rsplit('_').next().unwrap_or_default().to_owned(),
        dimension: group.dimension,
    };
    space.names().into_iter().zip(groups).map(parameter).collect()
}

impl Parameter {
    /// How closely a name is this parameter's; none if it is not.
    fn rank(&self, key: &str) -> Option<u8> {
        [&self.quantity, &self.group, &self.name].iter().rposition(|name| *name == key).map(|rank| rank as u8)
    }
}

impl Assignment<'_> {
    fn size(&self, parameter: &Parameter, nominal: f64) -> Result<ManufacturingError, ManufacturingErrorFault> {
        let fault =
            |message: String, hint: String| ManufacturingErrorFault { given: self.given.clone(), message, hint };
        let Parameter { name, dimension, .. } = parameter;
        let example = format!("write a share such as \"5 %\", or a quantity in {}", dimension.symbols().join(", "));
        let size = if let Some(percent) = self.value.strip_suffix('%') {
            let percent = percent.trim().parse().ok().filter(|percent| (0.0..=100.0).contains(percent));
            let percent: f64 =
                percent.ok_or_else(|| fault(format!("`{}` is no share from 0 to 100 %", self.value), example))?;
            0.01 * percent * nominal.abs()
        } else {
            parse_quantity(self.value, *dimension).map_err(|error| fault(error.to_string(), example))?
        };
        let told = |value: f64| readable(value, nominal, dimension.si());
        // Of a parameter that is 0, a share is nothing.
        if !(size > 0.0 && size.is_finite()) {
            let message = format!("{} is no error of {name}, which is {}", told(size), told(nominal));
            return Err(fault(message, "it has to be above 0".into()));
        }
        let least = nominal - size;
        if is_impossible(least, *dimension) {
            let message = format!("with {} less than {}, {name} would be {}", told(size), told(nominal), told(least));
            return Err(fault(message, "nothing can be built so: give a smaller error".into()));
        }
        Ok(ManufacturingError { size, text: self.value.to_owned() })
    }
}

/// Whether nothing can be built with this value. Limits of the search are no matter here: an error of the workshop may leave them.
fn is_impossible(value: f64, dimension: Dimension) -> bool {
    match dimension {
        Dimension::Length | Dimension::Mass | Dimension::Time | Dimension::Inertia | Dimension::Density => value <= 0.0,
        Dimension::Stiffness | Dimension::TorsionalStiffness | Dimension::Damping | Dimension::TorsionalDamping => {
            value < 0.0
        }
        // Signs are directions, or nothing is known.
        Dimension::None
        | Dimension::Speed
        | Dimension::Force
        | Dimension::Torque
        | Dimension::Angle
        | Dimension::AngularSpeed
        | Dimension::Acceleration
        | Dimension::Power
        | Dimension::Current
        | Dimension::Voltage => false,
    }
}
