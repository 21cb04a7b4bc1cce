//! Arguments of queue and workers.

use std::net::IpAddr;
use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Subcommand;
use hwasp_cluster::Server;

use super::parse::{path, threads, whole};

/// The most workers that are started or asked for at once.
const MOST_WORKERS: u64 = 10_000;

/// How a server lets somebody in.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Workers on other machines")]
pub(crate) struct ConnectArgs {
    /// The file that holds the server's token
    #[arg(long, value_name = "FILE", value_parser = path())]
    token_file: Option<PathBuf>,
    /// The certificates by which the server is known, PEM [default: the system's]
    #[arg(long, value_name = "FILE", value_parser = path())]
    tls_ca: Option<PathBuf>,
    /// Our own certificate, PEM, where the server wants to know us
    #[arg(long, value_name = "FILE", value_parser = path(), requires = "tls_key")]
    tls_cert: Option<PathBuf>,
    /// Its key, PEM
    #[arg(long, value_name = "FILE", value_parser = path(), requires = "tls_cert")]
    tls_key: Option<PathBuf>,
}

impl ConnectArgs {
    /// The server at this address.
    pub(crate) fn server(&self, address: &str) -> Server {
        Server {
            address: address.to_owned(),
            token: self.token_file.clone(),
            authority: self.tls_ca.clone(),
            certificate: self.tls_cert.clone().zip(self.tls_key.clone()),
        }
    }
}

#[derive(Debug, clap::Args)]
pub(crate) struct WorkerArgs {
    /// The queue that it takes jobs from, such as `nats://127.0.0.1:4222`
    #[arg(long, value_name = "ADDRESS")]
    pub(crate) server: String,
    #[command(flatten)]
    pub(crate) connect: ConnectArgs,
    /// Jobs at once, a thread each [default: the processors there are]
    #[arg(long, allow_negative_numbers = true, value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// What it is called [default: this machine's name and the number of the process]
    #[arg(long, value_parser = name)]
    pub(crate) name: Option<String>,
    /// End when standard input does: whoever started it is gone
    #[arg(long, hide = true)]
    pub(crate) until_input_ends: bool,
}

/// An address of this machine.
fn address(text: &str) -> Result<IpAddr, String> {
    let why = "it has to be an address such as 127.0.0.1, 10.0.0.5 or ::1; a name goes to --host";
    text.parse().map_err(|_| why.to_owned())
}

/// A name that can be told in a table.
fn name(text: &str) -> Result<String, String> {
    let plain = |c: char| c.is_alphanumeric() || "-._".contains(c);
    if (1..=64).contains(&text.len()) && text.chars().all(plain) {
        return Ok(text.to_owned());
    }
    Err("it has to be 1 to 64 letters, digits, points, hyphens and underscores".to_owned())
}

#[derive(Debug, clap::Args)]
pub(crate) struct ClusterArgs {
    #[command(subcommand)]
    pub(crate) command: ClusterCommand,
}

#[derive(Debug, Subcommand)]
pub(crate) enum ClusterCommand {
    /// Start a queue on this machine, and workers, until Ctrl-C
    Up(UpArgs),
    /// Say what waits and who works: queue, workers, their rates, who is slow
    Status(StatusArgs),
    /// Measure what queue and workers are able to do: empty jobs in a second, bytes in a second
    Measure(MeasureArgs),
    /// Write sbatch scripts for Slurm: one for the queue, one for an array of workers
    Slurm(SlurmArgs),
}

#[derive(Debug, clap::Args)]
pub(crate) struct UpArgs {
    /// Workers that are started with it
    #[arg(long, default_value = "1", allow_negative_numbers = true, value_parser = whole(0..=MOST_WORKERS))]
    pub(crate) workers: u64,
    /// Threads of each [default: the processors there are, shared out]
    #[arg(long, allow_negative_numbers = true, value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// The address where the queue listens. Elsewhere than on loopback take --tls-cert and --tls-key, too
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1", value_parser = address)]
    pub(crate) bind: IpAddr,
    /// What others call this machine, as the certificate does [default: the address where it listens]
    #[arg(long, value_name = "NAME", value_parser = name)]
    pub(crate) host: Option<String>,
    /// Its port [default: 4222, or one of the nine behind it]
    #[arg(long, allow_negative_numbers = true, value_parser = whole(1..=65_535))]
    pub(crate) port: Option<u64>,
    /// The folder of what the queue keeps, of its token and its log
    #[arg(long, value_name = "FOLDER", default_value = "runs/queue", value_parser = path())]
    pub(crate) store: PathBuf,
    /// What the queue keeps at most, GB
    #[arg(long, value_name = "GB", default_value = "20", allow_negative_numbers = true, value_parser = whole(1..=100_000))]
    pub(crate) most: u64,
    /// The queue's certificate, PEM, for TLS
    #[arg(long, value_name = "FILE", value_parser = path(), requires = "tls_key")]
    pub(crate) tls_cert: Option<PathBuf>,
    /// Its key, PEM
    #[arg(long, value_name = "FILE", value_parser = path(), requires = "tls_cert")]
    pub(crate) tls_key: Option<PathBuf>,
    /// The certificates by which workers know it, PEM [default: its own, for one that signed itself]
    #[arg(long, value_name = "FILE", value_parser = path(), requires = "tls_cert")]
    pub(crate) tls_ca: Option<PathBuf>,
    /// Keep the queue's address in this file as long as it listens
    #[arg(long, value_name = "FILE", value_parser = path())]
    pub(crate) address_file: Option<PathBuf>,
    /// The program `nats-server`, where it is not on the path
    #[arg(long, value_name = "FILE", value_parser = path())]
    pub(crate) nats_server: Option<PathBuf>,
}

#[derive(Debug, clap::Args)]
pub(crate) struct StatusArgs {
    /// The queue, such as `nats://127.0.0.1:4222`
    #[arg(long, value_name = "ADDRESS")]
    pub(crate) server: String,
    #[command(flatten)]
    pub(crate) connect: ConnectArgs,
    /// Print JSON, for scripts
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, clap::Args)]
pub(crate) struct MeasureArgs {
    #[command(flatten)]
    pub(crate) queue: StatusArgs,
    /// Empty jobs that the workers are flooded with
    #[arg(long, default_value = "10000", allow_negative_numbers = true, value_parser = whole(1..=10_000_000))]
    pub(crate) jobs: u64,
}

#[derive(Debug, clap::Args)]
pub(crate) struct SlurmArgs {
    /// The folder of the scripts, server.sbatch and workers.sbatch; those of the same name are replaced
    #[arg(long, value_name = "FOLDER", default_value = ".", value_parser = path())]
    pub(crate) out: PathBuf,
    /// A folder that all nodes see, for the queue, its token and its address
    #[arg(long, value_name = "FOLDER", default_value = "hwasp-cluster", value_parser = path())]
    pub(crate) shared: PathBuf,
    /// Workers
    #[arg(long, default_value = "16", allow_negative_numbers = true, value_parser = whole(1..=MOST_WORKERS))]
    pub(crate) workers: u64,
    /// Threads of each
    #[arg(long, default_value = "4", allow_negative_numbers = true, value_parser = threads)]
    pub(crate) threads: NonZeroUsize,
    /// The partition, or several with commas [default: Slurm's]
    #[arg(long, value_parser = partitions)]
    pub(crate) partition: Option<String>,
    /// Time limit, as Slurm writes it
    #[arg(long, default_value = "12:00:00", value_parser = slurm_time)]
    pub(crate) time: String,
    /// Memory of a worker, as Slurm writes it
    #[arg(long, default_value = "4G", value_parser = slurm_memory)]
    pub(crate) memory: String,
    /// The program `nats-server`, where it is not on the nodes' path
    #[arg(long, value_name = "FILE", value_parser = path())]
    pub(crate) nats_server: Option<PathBuf>,
}

/// Names of partitions.
fn partitions(text: &str) -> Result<String, String> {
    text.split(',').map(name).collect::<Result<Vec<_>, _>>().map(|names| names.join(","))
}

/// A time as Slurm has it: minutes, hours:minutes:seconds, days-hours:minutes:seconds.
fn slurm_time(text: &str) -> Result<String, String> {
    let plain = text.chars().all(|c| c.is_ascii_digit() || c == ':' || c == '-');
    if plain && text.starts_with(|c: char| c.is_ascii_digit()) && text.ends_with(|c: char| c.is_ascii_digit()) {
        return Ok(text.to_owned());
    }
    Err("it has to be a time such as 90 (minutes), 12:00:00 or 2-00:00:00".to_owned())
}

/// Memory as Slurm has it.
fn slurm_memory(text: &str) -> Result<String, String> {
    let number = text.trim_end_matches(['K', 'M', 'G', 'T']);
    if text.len() - number.len() <= 1 && !number.is_empty() && number.chars().all(|c| c.is_ascii_digit()) {
        return Ok(text.to_owned());
    }
    Err("it has to be a size such as 4G or 800M".to_owned())
}
