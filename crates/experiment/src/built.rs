//! Problems built, and what experiments rely on in them.

use hwasp_core::MOST_TERMS;
use hwasp_problem::{AnyError, AnyProblem, Built};
use hwasp_settings::text::{column_fault, shorten};
use hwasp_settings::{AnySettings, listed};

/// The longest episode, steps.
pub const MOST_STEPS: usize = 100_000;
/// Keys of `[task]` that every problem has.
pub(crate) const COMMON_KEYS: [&str; 2] = ["problem", "horizon"];
/// Columns of a learning curve that are not a design group's, the last three in those of earlier versions.
const COLUMNS: [&str; 10] = [
    "iteration",
    "env_steps",
    "wall_s",
    "discounted_return",
    "return",
    "episodes",
    "episode_steps",
    "kl",
    "entropy",
    "step_fraction",
];
/// The most groups of a design: each has a column in learning curves.
pub const MOST_GROUPS: usize = 64;

/// Builds a problem and checks what experiments rely on.
pub(crate) fn build(problem: &dyn AnyProblem, settings: &dyn AnySettings) -> Result<Built, AnyError> {
    let built = problem.build(settings)?;
    let (env, groups) = (&built.training.env, built.training.law.design().groups());
    if built.optimum.len() != groups.len() {
        let (given, needed) = (built.optimum.len(), groups.len());
        return Err(format!("the optimum of {given} design groups is given, but there are {needed}").into());
    }
    for name in [env, &built.deployment.env].into_iter().flat_map(|env| &env.shaped_by) {
        if groups.iter().all(|group| group.name != *name) {
            let known = listed(groups.iter().map(|group| group.name.as_str()));
            return Err(format!("its world is made from `{name}`, which is no group of the design: {known}").into());
        }
    }
    if !(1..=MOST_STEPS).contains(&env.horizon) {
        return Err(format!("its horizon is {} steps, not between 1 and {MOST_STEPS}", env.horizon).into());
    }
    if groups.len() > MOST_GROUPS {
        let found = groups.len();
        return Err(format!("its design has {found} groups, and learning curves have columns for {MOST_GROUPS}").into());
    }
    for group in groups {
        check_group(&group.name)?;
    }
    if env.terms.len() > MOST_TERMS {
        let found = env.terms.len();
        return Err(format!("its reward has {found} terms, and learning curves have columns for {MOST_TERMS}").into());
    }
    for (i, term) in env.terms.iter().enumerate() {
        let twice = || env.terms[..i].contains(term).then(|| "another term is called so".to_owned());
        if let Some(why) = column_fault(term).or_else(twice) {
            return Err(format!("the term `{}` of its reward cannot be called so: {why}", shorten(term, 60)).into());
        }
    }
    let columns: Vec<String> = groups.iter().map(|group| total_name(&group.name, group.count)).collect();
    for (i, column) in columns.iter().enumerate() {
        if let Some(other) = columns[..i].iter().position(|other| other == column) {
            let (one, other) = (&groups[other].name, &groups[i].name);
            return Err(format!(
                "the design groups `{one}` and `{other}` would both be the column `{column}` of learning curves: rename one"
            )
            .into());
        }
    }
    Ok(built)
}

/// The column of a design group in learning curves: its total; a group of one is its own.
pub fn total_name(group: &str, count: usize) -> String {
    if count == 1 { group.to_owned() } else { format!("{group}_total") }
}

/// Whether a design group can name a column of a learning curve.
fn check_group(name: &str) -> Result<(), AnyError> {
    let why = if let Some(why) = column_fault(name) {
        why
    } else if COLUMNS.contains(&name) {
        format!("learning curves have a column of this name, as of {}", listed(COLUMNS))
    } else {
        return Ok(());
    };
    Err(format!("the design group `{}` cannot be called so: {why}", shorten(name, 60)).into())
}
