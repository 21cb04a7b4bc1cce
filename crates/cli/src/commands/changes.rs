//! `hwasp design` of an experiment, or with `--at`: what another design changes of the model.

use std::collections::BTreeSet;
use std::fmt::Write;

use hwasp_core::{DesignSpace, Initial, parse_quantity};
use hwasp_experiment::{Catalogue, load, resolve};
use hwasp_problem::Changed;
use hwasp_runs::text::{ReadableUnit, quantity};
use hwasp_settings::text::{shorten, show};
use hwasp_settings::{listed, nearest, with_unit};
use hwasp_training::Assembly;

use super::saved_run;
use crate::args::DesignArgs;
use crate::output;
use hwasp_session::Failure;

/// Two designs, SI, and how they differ.
struct Pair {
    what: String,
    before: Vec<f64>,
    after: Vec<f64>,
}

pub(super) fn run(args: &DesignArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    if args.out.is_some() {
        let message = "--out names a folder for the closing chart, and what a design changes is not drawn";
        return Err(Failure::input(message).hint("leave it out"));
    }
    let (assembly, base) = if args.run.is_dir() {
        let saved = saved_run(&args.run, &[], catalogue)?;
        let params = saved.params().map_err(Failure::input)?;
        (saved.assembly().clone(), saved.assembly().built(&params))
    } else {
        let layers = load(&args.run.to_string_lossy(), catalogue).map_err(Failure::input)?;
        let spec = resolve(layers, None, catalogue).map_err(Failure::input)?;
        let assembly = Assembly::new(&spec).map_err(Failure::input)?;
        let base = first(&assembly);
        (assembly, base)
    };
    let (task, space) = (&assembly.experiment().task, assembly.policy.space());
    let pairs = if args.at.is_empty() { ends(&assembly, &base) } else { vec![asked(space, &base, &args.at)?] };
    if pairs.is_empty() {
        let message = format!("no design parameter shapes the model of {}", assembly.experiment().name);
        let hint = "`sets` lets a parameter shape a model; --at NAME=VALUE asks for the parameters of the law";
        return Err(Failure::input(message).hint(hint));
    }
    let Some(mechanism) = &task.built().mechanism else {
        let message = format!("{} has no model that could be compared", task.name());
        return Err(Failure::input(message).hint("problem = \"model\" has one"));
    };
    let mut told = Vec::new();
    for pair in pairs {
        let changes =
            mechanism.changes(&pair.before, &pair.after).map_err(|error| Failure::input(error.to_string()))?;
        told.push((pair.what, changes));
    }
    if args.json {
        let one = |c: &Changed| serde_json::json!({ "name": c.name, "unit": c.unit, "before": c.before, "after": c.after, "follows": c.follows });
        let all = told.iter().map(|(what, changes)| {
            serde_json::json!({ "design": what, "changes": changes.iter().map(one).collect::<Vec<_>>() })
        });
        return Ok(output::print(&format!("{}\n", serde_json::to_string_pretty(&all.collect::<Vec<_>>())?))?);
    }
    let texts: Vec<String> = told.iter().map(|(what, changes)| text(what, changes)).collect();
    Ok(output::print(&texts.join("\n"))?)
}

/// Where the design begins, to the last bit where it is given.
fn first(assembly: &Assembly) -> Vec<f64> {
    let mut design = assembly.built(&assembly.init());
    let groups = assembly.worlds.training.law.design().groups().iter();
    let starts = groups.flat_map(|group| std::iter::repeat_n(group.initial, group.count));
    for (value, start) in design.iter_mut().zip(starts) {
        if let Initial::Value(given) = start {
            *value = given;
        }
    }
    design
}

/// Each parameter that shapes the model at its lower and at its upper limit.
fn ends(assembly: &Assembly, base: &[f64]) -> Vec<Pair> {
    let (space, env) = (assembly.policy.space(), &assembly.worlds.training.env);
    let mut pairs = Vec::new();
    let mut first = 0;
    for group in space.groups() {
        let own = first..first + group.count;
        first += group.count;
        if !env.shaped_by.contains(&group.name) {
            continue;
        }
        let with = |value: f64| {
            let mut design = base.to_vec();
            design[own.clone()].fill(value);
            design
        };
        let [low, high] = [group.lo, group.hi].map(|end| with_unit(end, group.dimension));
        let what = format!("{} = {low}, then {high}", group.name);
        pairs.push(Pair { what, before: with(group.lo), after: with(group.hi) });
    }
    pairs
}

/// The design with the values of `--at`.
fn asked(space: &DesignSpace, base: &[f64], at: &[String]) -> Result<Pair, Failure> {
    let mut after = base.to_vec();
    let mut what = Vec::new();
    let mut seen = BTreeSet::new();
    for text in at {
        let wrong =
            |message: String, hint: &str| Failure::input(format!("--at {}: {message}", shorten(text, 60))).hint(hint);
        let Some((name, value)) = text.split_once('=').map(|(name, value)| (name.trim(), value.trim())) else {
            return Err(wrong("it has no `=`".to_owned(), "write it like --at shank=\"0.6 m\""));
        };
        let groups = space.groups();
        let Some(place) = groups.iter().position(|group| group.name == name) else {
            let names = || groups.iter().map(|group| group.name.as_str());
            let hint = nearest(name, names()).map_or_else(
                || {
                    if groups.is_empty() {
                        "nothing is designed".to_owned()
                    } else {
                        format!("the parameters are {}", listed(names()))
                    }
                },
                |near| format!("did you mean `{near}`?"),
            );
            return Err(wrong(format!("`{}` is no design parameter", shorten(name, 60)), &hint));
        };
        let group = &groups[place];
        if !seen.insert(name) {
            return Err(wrong(format!("`{name}` is given twice"), "leave one of them out"));
        }
        let middle = with_unit(0.5 * (group.lo + group.hi), group.dimension);
        let si = parse_quantity(value.trim_matches('"'), group.dimension)
            .map_err(|error| wrong(error.to_string(), &format!("write it like --at {name}=\"{middle}\"")))?;
        if !(group.lo..=group.hi).contains(&si) {
            let (lo, hi) = (show(group.lo), with_unit(group.hi, group.dimension));
            return Err(wrong(format!("{name} is outside of its limits [{lo}, {hi}]"), "take a value between them"));
        }
        let first: usize = groups[..place].iter().map(|group| group.count).sum();
        let shown = |value| ReadableUnit { unit: group.dimension.si().to_owned(), to_si: 1.0 }.with_unit(value);
        what.push(format!("{name} = {}, before {}", shown(si), shown(base[first])));
        after[first..first + group.count].fill(si);
    }
    Ok(Pair { what: what.join("; "), before: base.to_vec(), after })
}

/// Two tables: what is set, and what follows.
fn text(what: &str, changes: &[Changed]) -> String {
    let mut text = format!("{what}\n");
    // Writing to a string cannot fail.
    if changes.is_empty() {
        let _ = writeln!(text, "  the model stays as it is");
    }
    let widest = changes.iter().map(|change| change.name.chars().count()).max().unwrap_or(0);
    for (title, follows) in [("sets", false), ("so that", true)] {
        let own: Vec<&Changed> = changes.iter().filter(|change| change.follows == follows).collect();
        if !own.is_empty() {
            let _ = writeln!(text, "  {title:<widest$}  {:>18}{:>18}", "before", "after");
        }
        for change in own {
            let [before, after] = [change.before, change.after].map(|value| quantity(value, &change.unit));
            let _ = writeln!(text, "  {:<widest$}  {before:>18}{after:>18}", change.name);
        }
    }
    text
}
