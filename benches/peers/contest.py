"""Programs that do the same work, in turns."""
import os
import resource
import statistics
import time


class Contest:
    """What every program reached, in units of work per second: `rates[program][setting]`, one number a turn.

    `programs[program][setting]` is called for one measurement. In the first turn every setting is tried; in the
    others each program runs with its fastest one, so that a busy machine is busy for all.
    """

    def __init__(self, programs, turns):
        busy, own, began = machine_time(), children_time(), time.perf_counter()
        self.rates = {name: {setting: [] for setting in settings} for name, settings in programs.items()}
        for turn in range(turns):
            for name, settings in programs.items():
                for setting in settings if turn == 0 else [self.best(name)]:
                    rate = settings[setting]()
                    self.rates[name][setting].append(rate)
                    print(f"  turn {turn + 1}: {name}, {setting}: {rate:,.4g}/s", flush=True)
        wall = time.perf_counter() - began
        foreign = machine_time() - busy - (children_time() - own)
        self.foreign = max(foreign, 0.0) / (wall * os.cpu_count())

    def best(self, name):
        """The setting that did best in the first turn."""
        return max(self.rates[name], key=lambda setting: self.rates[name][setting][0])

    def median(self, name):
        """The median rate of a program with its best setting."""
        return statistics.median(self.rates[name][self.best(name)])

    def table(self, subject, unit, scale=1.0):
        """One row per setting; ratios are those of the first program's median to each."""
        names = list(self.rates)
        lines = [f"| program | setting | {unit}, median | lowest to highest | runs | {names[0]} is faster by |",
                 "|---|---|---|---|---|---|"]
        for name, settings in self.rates.items():
            for setting, rates in sorted(settings.items(), key=lambda item: item[0] != self.best(name)):
                middle = statistics.median(rates)
                span = f"{scale * min(rates):,.4g} to {scale * max(rates):,.4g}" if len(rates) > 1 else ""
                ratio = "" if name == names[0] else f"{self.median(names[0]) / middle:.2f}"
                lines.append(f"| {name} | {setting} | {scale * middle:,.4g} | {span} | {len(rates)} | {ratio} |")
        lines += ["", f"{subject} Other programs took {100 * self.foreign:.0f} % of the machine's cores meanwhile."]
        return lines


def machine_time():
    """Processor seconds that all programs of the machine have used, idle time and waiting left out."""
    with open("/proc/stat") as file:
        fields = [int(number) for number in file.readline().split()[1:9]]
    user, nice, system, _idle, _iowait, irq, softirq, steal = fields
    return (user + nice + system + irq + softirq + steal) / os.sysconf("SC_CLK_TCK")


def children_time():
    """Processor seconds of this program and of all it has started and waited for."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in used)
