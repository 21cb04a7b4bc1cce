//! Scripts for Slurm: one for the server, and an array of workers.

/// What the scripts ask of Slurm.
#[derive(Clone, Debug)]
pub struct SlurmOptions {
    /// The program, as the nodes find it.
    pub program: String,
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
        let SlurmOptions { program, folder, partition, time, memory, workers, threads } = options;
        let (program, folder) = (quoted(program), quoted(folder));
        let partition = partition.as_ref().map_or(String::new(), |name| format!("#SBATCH --partition={name}\n"));
        let last = workers.saturating_sub(1);
        let server = format!(
            "#!/bin/bash\n\
             # The queue. `sbatch server.sbatch` once; it ends with `scancel`, and keeps what it has.\n\
             #SBATCH --job-name=hwasp-queue\n\
             {partition}#SBATCH --time={time}\n\
             #SBATCH --cpus-per-task=2\n\
             #SBATCH --mem=4G\n\
             #SBATCH --requeue\n\
             #SBATCH --open-mode=append\n\
             # A minute before the end it is asked to end.\n\
             #SBATCH --signal=B:TERM@60\n\
             set -eu\n\
             folder={folder}\n\
             mkdir -p \"$folder\"\n\
             # The address of this node that others reach; the nodes' network is taken to be the cluster's own.\n\
             address=$(hostname -I | cut -d' ' -f1)\n\
             exec {program} cluster up --workers 0 --bind \"$address\" --store \"$folder/queue\" --address-file \"$folder/address\"\n"
        );
        let workers = format!(
            "#!/bin/bash\n\
             # Workers: `sbatch workers.sbatch`, as often as there is room. Any of them may be preempted at any time.\n\
             #SBATCH --job-name=hwasp-worker\n\
             {partition}#SBATCH --time={time}\n\
             #SBATCH --array=0-{last}\n\
             #SBATCH --cpus-per-task={threads}\n\
             #SBATCH --mem={memory}\n\
             #SBATCH --requeue\n\
             #SBATCH --open-mode=append\n\
             # A minute before the end it takes no further jobs, and what it is at keeps its state.\n\
             #SBATCH --signal=B:TERM@60\n\
             set -eu\n\
             folder={folder}\n\
             # The queue may begin after its workers.\n\
             until [ -s \"$folder/address\" ]; do sleep 5; done\n\
             exec {program} worker --server \"$(cat \"$folder/address\")\" --token-file \"$folder/queue/token\" \\\n  \
             --threads \"${{SLURM_CPUS_PER_TASK:-{threads}}}\" --name \"$(hostname)-${{SLURM_ARRAY_JOB_ID:-0}}-${{SLURM_ARRAY_TASK_ID:-0}}\"\n"
        );
        Self { server, workers }
    }
}

/// As a shell takes it for one word.
fn quoted(text: &str) -> String {
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
            assert!(script.contains(r"exec '/opt/lab'\''s tools/hwasp' "), "{script}");
            let shell = Command::new("bash").arg("-n").stdin(Stdio::piped()).stderr(Stdio::piped()).spawn();
            let mut shell = shell.unwrap();
            shell.stdin.take().unwrap().write_all(script.as_bytes()).unwrap();
            let checked = shell.wait_with_output().unwrap();
            assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stderr));
        }
        assert!(workers.contains("#SBATCH --array=0-15\n"), "{workers}");
    }
}
