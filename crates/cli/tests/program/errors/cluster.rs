//! Queue and workers. Nothing listens at port 9 of this machine.

use super::Given::{Made, Nothing};
use super::{Case, case};

pub(super) const CASES: &[Case] = &[
    case("A queue at no address", Nothing, "hwasp train reach --server 127.0.0.1:4222"),
    case("A token in an address", Nothing, "hwasp worker --server nats://secret@box.lab:4222"),
    case("A worker of no queue", Nothing, "hwasp worker"),
    case("A queue that is not there", Nothing, "hwasp worker --server nats://127.0.0.1:9"),
    case("A training by a queue that is not there", Nothing, "hwasp train reach --server nats://127.0.0.1:9 --out run"),
    case("A token that is not there", Nothing, "hwasp cluster status --server nats://127.0.0.1:9 --token-file token"),
    case(
        "A token of two words",
        Made(|s| {
            s.write("token", "open sesame");
            std::fs::set_permissions(s.path("token"), std::os::unix::fs::PermissionsExt::from_mode(0o600)).unwrap();
        }),
        "hwasp cluster status --server nats://127.0.0.1:9 --token-file token",
    ),
    case("A certificate without its key", Nothing, "hwasp worker --server tls://127.0.0.1:9 --tls-cert mine.pem"),
    case("A worker without a name", Nothing, "hwasp worker --server nats://127.0.0.1:9 --name 'two words'"),
    case("A queue without its program", Nothing, "hwasp cluster up --nats-server missing"),
    case("A queue at no place", Nothing, "hwasp cluster up --bind box.lab"),
    case("A time that Slurm does not know", Nothing, "hwasp cluster slurm --time soon"),
    case("Memory that Slurm does not know", Nothing, "hwasp cluster slurm --memory much"),
];
