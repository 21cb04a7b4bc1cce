//! `hwasp cluster`.

use std::fs;
use std::num::NonZeroUsize;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use hwasp_cluster::{LocalServer, Scripts, Server, ServerOptions, SlurmOptions, measure, status};
use hwasp_experiment::Catalogue;

use super::{stop_on_signal, unwritten, write_out};
use crate::args::{ClusterArgs, ClusterCommand, MeasureArgs, SlurmArgs, StatusArgs, UpArgs};
use crate::{log, output, report};
use hwasp_session::Failure;
use hwasp_session::identity;

/// How often it is looked after what was started.
const LOOK: Duration = Duration::from_millis(200);
/// How long workers may take to come to their end.
const END: Duration = Duration::from_mins(5);
/// How long a measurement waits for a first worker.
const ALONE: Duration = Duration::from_secs(20);

pub(crate) fn run(args: &ClusterArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    match &args.command {
        ClusterCommand::Up(up) => self::up(up),
        ClusterCommand::Status(args) => tell(args),
        ClusterCommand::Measure(args) => measured(args, catalogue),
        ClusterCommand::Slurm(args) => slurm(args),
    }
}

fn up(args: &UpArgs) -> Result<(), Failure> {
    let stop = stop_on_signal()?;
    let options = ServerOptions {
        program: args.nats_server.clone(),
        bind: args.bind,
        port: args.port.and_then(|port| u16::try_from(port).ok()),
        store: args.store.clone(),
        most_bytes: args.most * 1_000_000_000,
        certificate: args.tls_cert.clone().zip(args.tls_key.clone()),
        authority: args.tls_ca.as_ref().or(args.tls_cert.as_ref()).map(std::path::absolute).transpose()?,
        host: args.host.clone(),
    };
    let mut local = LocalServer::start(&options).map_err(Failure::input)?;
    log::with_times();
    let server = local.server.clone();
    if !args.bind.is_loopback() && options.certificate.is_none() {
        tracing::warn!(
            "the queue can be reached from other machines, and without TLS its token can be read on the way"
        );
    }
    if args.bind.is_unspecified() && args.host.is_none() {
        tracing::warn!(
            "{} is how this machine alone reaches the queue; --host names what others call it",
            server.address
        );
    }
    let workers = usize::try_from(args.workers).unwrap_or(usize::MAX);
    let threads = args.threads.map_or_else(|| share(workers), NonZeroUsize::get);
    let mut crew: Vec<Started> = (0..workers).map(|i| Started::new(i, threads, &server)).collect::<Result<_, _>>()?;
    let _address = args.address_file.as_deref().map(|path| AddressFile::write(path, &server.address)).transpose()?;
    output::print(&told(&server, workers, threads))?;
    while !stop.load(Ordering::Relaxed) {
        std::thread::sleep(LOOK);
        // A signal to all processes of a job ends the queue, too.
        if local.ended() && !stop.load(Ordering::Relaxed) {
            crew.iter_mut().for_each(Started::ask_to_end);
            let log = args.store.join(hwasp_cluster::Stored::LOG);
            return Err(Failure::from(std::io::Error::other("the queue has ended by itself"))
                .hint(&format!("{} has its log; the same command begins again with what it kept", log.display())));
        }
        for worker in &mut crew {
            worker.look_after(threads, &server)?;
        }
    }
    output::remark("ending: workers come to the end of their jobs, or keep their state");
    crew.iter_mut().for_each(Started::ask_to_end);
    let began = Instant::now();
    while began.elapsed() < END && !crew.iter_mut().all(Started::ended) {
        std::thread::sleep(LOOK);
    }
    crew.iter_mut().for_each(Started::make_end);
    Ok(())
}

/// The file that has the queue's address as long as the queue is there: who reads it later waits for the next one.
struct AddressFile<'a>(&'a Path);

impl<'a> AddressFile<'a> {
    fn write(path: &'a Path, address: &str) -> Result<Self, Failure> {
        fs::write(path, format!("{address}\n")).map_err(|error| {
            let error = std::io::Error::new(error.kind(), format!("`{}` cannot be written: {error}", path.display()));
            Failure::from(error).hint("name a file in a folder that is there and may be written, with --address-file")
        })?;
        Ok(Self(path))
    }
}

impl Drop for AddressFile<'_> {
    fn drop(&mut self) {
        let _ = fs::remove_file(self.0);
    }
}

/// What there is now, and what to do with it.
fn told(server: &Server, workers: usize, threads: usize) -> String {
    let options = server.options();
    let address = &server.address;
    let of = if threads == 1 { "a thread".to_owned() } else { format!("{threads} threads") };
    let there = match workers {
        0 => "no workers".to_owned(),
        1 => format!("a worker with {of}"),
        _ => format!("{workers} workers with {of} each"),
    };
    format!(
        "{address}: a queue, and {there}. Ctrl-C ends all of it.\n\n  \
         hwasp train EXPERIMENT {options}\n  \
         hwasp worker {options}\n  \
         hwasp cluster status {options}\n"
    )
}

/// Threads for each of so many workers.
fn share(workers: usize) -> usize {
    let all = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    (all / workers.max(1)).max(1)
}

/// A worker that was started with the queue.
struct Started {
    child: Child,
    index: usize,
    since: Instant,
}

impl Started {
    fn new(index: usize, threads: usize, server: &Server) -> Result<Self, Failure> {
        let mut command = Command::new(std::env::current_exe()?);
        command.args(["worker", "--until-input-ends", "--server", &server.address]);
        command.args(["--name", &format!("local-{}", index + 1), "--threads", &threads.to_string()]);
        for (option, file) in [("--token-file", &server.token), ("--tls-ca", &server.authority)] {
            if let Some(file) = file {
                command.arg(option).arg(file);
            }
        }
        // Ctrl-C is for us alone: we ask it to end.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        Ok(Self { child: command.stdin(Stdio::piped()).spawn()?, index, since: Instant::now() })
    }

    /// Starts another one in the place of one that ended by itself.
    fn look_after(&mut self, threads: usize, server: &Server) -> Result<(), Failure> {
        // One that cannot even begin is not begun over and over.
        const REST: Duration = Duration::from_secs(5);
        if let Ok(Some(status)) = self.child.try_wait()
            && status.code() == Some(2)
        {
            let error = std::io::Error::other("its own worker cannot take jobs from it");
            return Err(Failure::from(error)
                .hint("what the worker says stands above; a certificate wants the name that it has, by --host"));
        }
        if self.ended() && self.since.elapsed() > REST {
            tracing::warn!("local-{} has ended by itself; another one takes its place", self.index + 1);
            *self = Self::new(self.index, threads, server)?;
        }
        Ok(())
    }

    fn ended(&mut self) -> bool {
        !matches!(self.child.try_wait(), Ok(None))
    }

    fn ask_to_end(&mut self) {
        drop(self.child.stdin.take());
    }

    fn make_end(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn tell(args: &StatusArgs) -> Result<(), Failure> {
    let server = args.connect.server(&args.server);
    let status = status(&server).map_err(Failure::input)?;
    let text = if args.json {
        format!("{}\n", serde_json::to_string_pretty(&status)?)
    } else {
        report::cluster::status(&status, &server.options())
    };
    Ok(output::print(&text)?)
}

fn measured(args: &MeasureArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let server = args.queue.connect.server(&args.queue.server);
    let measured = measure(&server, identity(catalogue)?, args.jobs, ALONE).map_err(Failure::input)?;
    let text = if args.queue.json {
        format!("{}\n", serde_json::to_string_pretty(&measured)?)
    } else {
        report::cluster::measured(&measured)
    };
    Ok(output::print(&text)?)
}

fn slurm(args: &SlurmArgs) -> Result<(), Failure> {
    let shared = std::path::absolute(&args.shared)?;
    let nats_server = args.nats_server.as_ref().map(std::path::absolute).transpose()?;
    let options = SlurmOptions {
        program: std::env::current_exe()?.display().to_string(),
        nats_server: nats_server.map(|path| path.display().to_string()),
        folder: shared.display().to_string(),
        partition: args.partition.clone(),
        time: args.time.clone(),
        memory: args.memory.clone(),
        workers: args.workers,
        threads: args.threads.get() as u64,
    };
    let Scripts { server, workers } = Scripts::new(&options);
    fs::create_dir_all(&args.out).map_err(|error| unwritten(&args.out, &error))?;
    let (first, second) = (args.out.join("server.sbatch"), args.out.join("workers.sbatch"));
    write_out(&first, &server)?;
    write_out(&second, &workers)?;
    let (first, second) = (output::shell(&first), output::shell(&second));
    let (address, token) = (shared.join("address"), shared.join("queue/token"));
    Ok(output::print(&format!(
        "sbatch {first}      the queue; it needs little, and has to outlive the trainings\n\
         sbatch {second}     workers: {}, {} jobs at once each\n\n\
         hwasp train EXPERIMENT --server \"$(cat {})\" --token-file {}\n",
        args.workers,
        args.threads,
        output::shell(&address),
        output::shell(&token)
    ))?)
}
