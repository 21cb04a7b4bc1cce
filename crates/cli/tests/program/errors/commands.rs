//! Command lines.

use std::fs;

use super::Given::{Made, Nothing};
use super::{Case, case};
use crate::sandbox::Sandbox;

pub(super) const CASES: &[Case] = &[
    case("A misspelt command", Nothing, "hwasp trian reach"),
    case("No experiment", Nothing, "hwasp train"),
    case("No run", Nothing, "hwasp eval"),
    case("No run to look at", Nothing, "hwasp play"),
    case("A plot of nothing", Nothing, "hwasp plot"),
    case("No run to watch", Nothing, "hwasp watch"),
    case("A file to watch", Made(|s| s.write("run", "a file")), "hwasp watch run"),
    case("A page at no address", Nothing, "hwasp watch run --bind everywhere"),
    case("A page by the address of another", Nothing, "hwasp watch run --host http://box.lan/"),
    case("A page of a training at no address", Nothing, "hwasp train reach --watch=0.0.0.0:99999"),
    case("A misspelt option", Nothing, "hwasp train reach --sed 3"),
    case("An option of a command before it", Nothing, "hwasp --threads 2 train reach"),
    case("A second experiment", Nothing, "hwasp train reach mass-spring"),
    case("A method that does not exist", Nothing, "hwasp train reach --method foo"),
    case("An option without its value", Nothing, "hwasp train reach --out"),
    case("A folder of no name", Nothing, "hwasp train reach --out ''"),
    case("A name that is no UTF-8", Nothing, "hwasp check \"$(printf '\\377.toml')\""),
    case("A negative seed", Nothing, "hwasp train reach --seed -1"),
    case("No threads", Nothing, "hwasp train reach --threads 0"),
    case("More steps than anyone can wait for", Nothing, "hwasp train reach --env-steps 1e99"),
    case("Fewer steps than an iteration", Nothing, "hwasp train reach --env-steps 100"),
    case("A time that is none", Nothing, "hwasp train reach --checkpoint-every never"),
    case("A negative time", Nothing, "hwasp train reach --checkpoint-every -1"),
    case("An unknown level of the log", Nothing, "hwasp train reach --log-level loud"),
    case("--set without a value", Nothing, "hwasp check reach --set ppo.clip_ratio"),
    case("--set without a key", Nothing, "hwasp check reach --set =3"),
    case("--set of a misspelt key", Nothing, "hwasp check reach --set ppo.clip_ration=0.1"),
    case("--set beyond the limits", Nothing, "hwasp check reach --set ppo.clip_ratio=7"),
    case("--set of a word for a number", Nothing, "hwasp check reach --set ppo.clip_ratio=much"),
    case("--set without a unit", Nothing, "hwasp check reach --set noise.effort=3"),
    case("--set of a whole table", Nothing, "hwasp check reach --set ppo=1"),
    case("--set of broken TOML", Nothing, "hwasp check reach --set 'design.initial={gear=\"1\"'"),
    case("--set for a method", Nothing, "hwasp check reach --set methods.minimal.ppo.clip_ratio=0.1"),
    case("Several at once", Nothing, "hwasp check reach --set ppo.clip_ratio=7 --set sed=1 --set train.env_steps=0"),
    case(
        "--set of a text of many pages",
        Nothing,
        "hwasp check reach --set description=\"$(head -c 20000 /dev/zero | tr '\\0' x)\"",
    ),
    case("To resume and to begin", Made(Sandbox::put_stopped_run), "hwasp train reach --resume run"),
    case("To resume with another seed", Made(Sandbox::put_stopped_run), "hwasp train --resume run --seed 1"),
    case(
        "To begin with a run of other sizes",
        Made(Sandbox::put_run),
        "hwasp train reach --from run --set controller.hidden=[7]",
    ),
    case(
        "To begin with a run of another problem",
        Made(Sandbox::put_run),
        "hwasp train bar-length --from run --set controller.hidden=[16] --set controller.squash=true",
    ),
    case("To begin a search with a run", Made(Sandbox::put_run), "hwasp train reach --from run --method cmaes"),
    case("To begin with a run that is not there", Nothing, "hwasp train reach --from run"),
    case("To begin and to resume", Made(Sandbox::put_stopped_run), "hwasp train --from run --resume run"),
    case("A contender that is none", Nothing, "hwasp compare reach --methods hwasp,hwsap"),
    case("A contender twice", Nothing, "hwasp compare reach --methods hwasp,hwasp"),
    case("No contender", Nothing, "hwasp compare reach --methods ''"),
    case("A contender that begins nowhere", Nothing, "hwasp compare reach --methods fixed:"),
    case("A contender with half a table", Nothing, "hwasp compare reach --methods 'hwasp,fixed:}'"),
    case("A contender whose table does not end", Nothing, "hwasp compare reach --methods 'fixed:{gear = 1,hwasp'"),
    case("A contender whose table is none", Nothing, "hwasp compare reach --methods 'fixed:{gear}'"),
    case("A contender with what is not designed", Nothing, "hwasp compare reach --methods 'fixed:{gaer = 1}'"),
    case("A contender that begins outside of its limits", Nothing, "hwasp compare reach --methods fixed:4"),
    case("Fewer steps than a generation", Nothing, "hwasp compare reach --methods cmaes --env-steps 300"),
    case("No seeds", Nothing, "hwasp compare reach --seeds 0"),
    case("A threshold that is no number", Nothing, "hwasp compare reach --threshold nan"),
    case("A figure that is none of the paper's", Nothing, "hwasp reproduce fig4"),
    case("A plot in an unknown format", Made(Sandbox::put_run), "hwasp plot run --out curves.jpg"),
    case("A plot in no format", Made(Sandbox::put_run), "hwasp plot run --out curves"),
    case("A plot against an unknown axis", Made(Sandbox::put_run), "hwasp plot run --axis days"),
    case("A drawing in an unknown format", Nothing, "hwasp graph reach --out law.pdf"),
    case("A drawing in no format", Nothing, "hwasp graph reach --out law"),
    case("An export of no samples", Made(Sandbox::put_run), "hwasp export run --samples 0"),
    case("Printed parts of what has none", Made(Sandbox::put_run), "hwasp export run --json --stl"),
    case("Parts of what is no hand", Made(Sandbox::put_run), "hwasp parts run"),
    case("A catalogue that is not there", Made(Sandbox::put_run), "hwasp parts run --catalogue springs.csv"),
    case(
        "A catalogue with wrong rows",
        Made(|s| {
            s.put_run();
            s.write(
                "springs.csv",
                "part,wire_mm,outer_mm,turns,leg_angle_deg,leg_mm\nT1,0.4,5.3,8.25,90,10\nT1,0.4,5.3,8.25,90,10\nT2,0.4,5.3,8.25,90\n\
                 T3,\"0,4\",5.3,8.25,90,10\nT4,4,5.3,8.25,90,10\n",
            );
        }),
        "hwasp parts run --catalogue springs.csv",
    ),
    case(
        "A catalogue with columns of its own",
        Made(|s| {
            s.put_run();
            s.write("springs.csv", "part,wire,outer_mm,turns,leg_angle_deg,leg_mm\nT1,0.4,5.3,8.25,90,10\n");
        }),
        "hwasp parts run --catalogue springs.csv",
    ),
    case("A workshop with a misspelt axle", Made(Sandbox::put_run), "hwasp parts run --bench axel='3 mm'"),
    case("A workshop without units", Made(Sandbox::put_run), "hwasp parts run --bench axle=3"),
    case("Holes that do not go round", Made(Sandbox::put_run), "hwasp parts run --bench hole_pitch='17 deg'"),
    case("An error of what is not designed", Made(Sandbox::put_run), "hwasp tolerances run --error radius='0.1 mm'"),
    case("An error without a size", Made(Sandbox::put_run), "hwasp tolerances run --error gear"),
    case("An error of nothing", Made(Sandbox::put_run), "hwasp tolerances run --error gear=0"),
    case("A fast law of what has none", Made(Sandbox::put_run), "hwasp eval run --law-rate physics"),
    case("Tendons of what has none", Made(Sandbox::put_run), "hwasp eval run --native-tendons"),
    case("A design of nothing", Nothing, "hwasp design nosuch"),
    case("A parameter with two values", Nothing, "hwasp design reach --at gear=1 --at gear=1.5"),
    case("A closing chart of what is no hand", Made(Sandbox::put_run), "hwasp design run --out pictures"),
    case("An evaluation of another problem", Made(Sandbox::put_run), "hwasp eval run --set task.problem=stiffness"),
    case("An evaluation of another network", Made(Sandbox::put_run), "hwasp eval run --set controller.hidden=[8]"),
    case(
        "An experiment that is a folder, for a drawing",
        Made(|s| fs::create_dir(s.path("folder")).unwrap()),
        "hwasp graph folder",
    ),
];
