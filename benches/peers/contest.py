"""Programs that do the same work, in turns."""
import os
import resource
import statistics
import time

# Turns in which every setting is tried.
TRIALS = 2


class Contest:
    """What every program reached, in units of work per second: `rates[program][setting]`, one number a turn.

    `programs[program][setting]` is called for one measurement. In the first two turns every setting is tried; in the
    others each program runs with its fastest one, so that a busy machine is busy for all.
    """

    def __init__(self, programs, turns):
        busy, own, began = machine_time(), children_time(), time.perf_counter()
        self.rates = {name: {setting: [] for setting in settings} for name, settings in programs.items()}
        for turn in range(turns):
            for name, settings in programs.items():
                for setting in settings if turn < TRIALS else [self.best(name)]:
                    rate = settings[setting]()
                    self.rates[name][setting].append(rate)
                    print(f"  turn {turn + 1}: {name}, {setting}: {show(rate)}/s", flush=True)
        wall = time.perf_counter() - began
        foreign = machine_time() - busy - (children_time() - own)
        self.foreign = max(foreign, 0.0) / (wall * os.cpu_count())

    def best(self, name):
        """The setting with the highest median so far."""
        return max(self.rates[name], key=lambda setting: statistics.median(self.rates[name][setting]))

    def median(self, name):
        """The median rate of a program with its best setting."""
        return statistics.median(self.rates[name][self.best(name)])

    def table(self, subject, unit):
        """One row per setting; ratios are those of the first program's median to each."""
        names = list(self.rates)
        lines = [f"| program | setting | {unit}, median | lowest to highest | runs | {names[0]} is faster by |",
                 "|---|---|---|---|---|---|"]
        for name, settings in self.rates.items():
            for setting, rates in sorted(settings.items(), key=lambda item: -statistics.median(item[1])):
                middle = statistics.median(rates)
                span = f"{show(min(rates))} to {show(max(rates))}"
                ratio = "" if name == names[0] else f"{self.median(names[0]) / middle:.2f}"
                lines.append(f"| {name} | {setting} | {show(middle)} | {span} | {len(rates)} | {ratio} |")
        lines += ["", f"{subject} Other programs took {100 * self.foreign:.0f} % of the machine's cores meanwhile."]
        return lines


def show(rate):
    """A rate with four digits or more."""
    return f"{rate:,.0f}" if rate >= 1000 else f"{rate:.4g}"


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
