//! Scripts for Slurm: one for the server, and an array of workers.

/// What the scripts ask of Slurm.
#[derive(Clone, Debug)]
pub struct SlurmOptions {
    /// The program, as the nodes find it.
    pub program: String,
    /// The program `nats-server`, where it is not on the nodes' path.
    pub nats_server: Option<String>,
    /// A folder that all nodes see: the queue, its token and its address lie there.
    pub folder: String,
    /// The partition; Slurm's own default where none is named.
    pub partition: Option<String>,
    /// The time limit of the workers, as Slurm writes it.
    pub time: String,
    /// Memory of a worker, as Slurm writes it.
    pub memory: String,
    /// Workers.
    pub workers: u64,
    /// Threads of each.
    pub threads: u64,
}

/// Two sbatch scripts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scripts {
    /// The server's.
    pub server: String,
    /// The workers', an array.
    pub workers: String,
}

impl Scripts {
    /// For these wishes.
    pub fn new(options: &SlurmOptions) -> Self {
        let SlurmOptions { program, nats_server, folder, partition, time, memory, workers, threads } = options;
        let (program, folder) = (quoted(program), quoted(folder));
        let nats_server =
            nats_server.as_ref().map_or(String::new(), |file| format!(" \\\n  --nats-server {}", quoted(file)));
        let partition = partition.as_ref().map_or(String::new(), |name| format!("#SBATCH --partition={name}\n"));
        let last = workers.saturating_sub(1);
        let server = format!(
            r#"#!/bin/bash
# The queue: `sbatch server.sbatch` once. `scancel` ends it, and the next one goes on with what it kept.
# What is said to sbatch itself goes before what is said here: sbatch --time=7-0 --account=lab server.sbatch
#SBATCH --job-name=hwasp-queue
{partition}#SBATCH --time={time}
#SBATCH --cpus-per-task=2
#SBATCH --mem=4G
#SBATCH --requeue
#SBATCH --open-mode=append
# A minute before the end it is asked to end.
#SBATCH --signal=B:TERM@60
set -eu
folder={folder}
mkdir -p "$folder"
# The address of this node that others reach. Where the first one is not in the cluster's own network, set HWASP_BIND.
address=${{HWASP_BIND:-$(hostname -I | cut -d' ' -f1)}}
exec {program} cluster up --workers 0 --bind "$address" \
  --store "$folder/queue" --address-file "$folder/address"{nats_server}
"#
        );
        let workers = format!(
            r#"#!/bin/bash
# Workers: `sbatch workers.sbatch`, as often as there is room. Any of them may be preempted at any time.
# What is said to sbatch itself goes before what is said here: sbatch --account=lab --array=0-99 workers.sbatch
#SBATCH --job-name=hwasp-worker
{partition}#SBATCH --time={time}
#SBATCH --array=0-{last}
#SBATCH --cpus-per-task={threads}
#SBATCH --mem={memory}
#SBATCH --requeue
#SBATCH --open-mode=append
# A minute before the end it takes no further jobs, and what it is at keeps its state.
#SBATCH --signal=B:USR1@60
set -eu
folder={folder}
worker=
ended=
trap 'ended=yes; [ -z "$worker" ] || kill "$worker" || true' USR1
# Slurm itself asks the worker to end, as all processes of the job.
trap 'ended=yes' TERM
# The queue may begin after its workers, and begin anew on another node: then the worker does, too.
address() {{ cat "$folder/address" 2>/dev/null || true; }}
while [ -z "$ended" ]; do
  server=$(address)
  if [ -n "$server" ]; then
    {program} worker --server "$server" --token-file "$folder/queue/token" \
      --threads "${{SLURM_CPUS_PER_TASK:-{threads}}}" \
      --name "$(hostname -s)-${{SLURM_ARRAY_JOB_ID:-0}}-${{SLURM_ARRAY_TASK_ID:-0}}" &
    worker=$!
    while [ -z "$ended" ] && kill -0 "$worker" 2>/dev/null; do
      now=$(address)
      if [ -n "$now" ] && [ "$now" != "$server" ]; then
        echo "the queue is at $now now"
        kill -KILL "$worker" || true
      fi
      sleep 5 || true
    done
    wait "$worker" || true
    worker=
  fi
  [ -n "$ended" ] || sleep 5 || true
done
"#
        );
        Self { server, workers }
    }
}

/// As a shell takes it for one word.
pub(crate) fn quoted(text: &str) -> String {
    let plain = !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric() || "-._/".contains(c));
    if plain { text.to_owned() } else { format!("'{}'", text.replace('\'', "'\\''")) }
}

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::process::{Command, Stdio};

    use super::*;

    /// A shell reads them, whatever folders are called.
    #[test]
    fn scripts_are_scripts() {
        let options = SlurmOptions {
            program: "/opt/lab's tools/hwasp".into(),
            nats_server: Some("/opt/it's/nats-server".into()),
            folder: "/scratch/a b/$HOME".into(),
            partition: Some("cpu".into()),
            time: "2-00:00:00".into(),
            memory: "4G".into(),
            workers: 16,
            threads: 4,
        };
        let Scripts { server, workers } = Scripts::new(&options);
        for script in [&server, &workers] {
            assert!(script.contains("#SBATCH --partition=cpu\n") && script.contains("#SBATCH --requeue\n"), "{script}");
            assert!(script.contains("folder='/scratch/a b/$HOME'\n"), "{script}");
            assert!(script.contains(r" '/opt/lab'\''s tools/hwasp' "), "{script}");
            let shell = Command::new("bash").arg("-n").stdin(Stdio::piped()).stderr(Stdio::piped()).spawn();
            let mut shell = shell.unwrap();
            shell.stdin.take().unwrap().write_all(script.as_bytes()).unwrap();
            let checked = shell.wait_with_output().unwrap();
            assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stderr));
        }
        assert!(workers.contains("#SBATCH --array=0-15\n"), "{workers}");
        assert!(server.ends_with(" --nats-server '/opt/it'\\''s/nats-server'\n"), "{server}");
    }
}
