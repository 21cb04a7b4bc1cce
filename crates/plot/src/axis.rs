//! Axes: ranges, round ticks and their labels.

/// An axis from `low` to `high`, with ticks at round numbers inside.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axis {
    pub(super) low: f64,
    pub(super) high: f64,
    step: f64,
}

impl Axis {
    /// An axis of steps or seconds: from 0 to the last one drawn, about five ticks.
    pub(super) fn of_progress(last: f64) -> Self {
        let high = last.max(1.0);
        // There are no parts of steps, and parts of seconds do not matter.
        Self { low: 0.0, high, step: round_step(high, 5.0).max(1.0) }
    }

    /// An axis that holds `low` to `high` with a little room, four to seven ticks.
    pub(super) fn of_values(low: f64, high: f64) -> Self {
        let size = low.abs().max(high.abs());
        // A constant curve still gets a range in which ticks differ.
        let least = if size > 1e-90 { 0.02 * size } else { 1.0 };
        let extra = (0.06 * (high - low)).max((least - (high - low)) / 2.0);
        let (mut padded_low, mut padded_high) = (low - extra, high + extra);
        // Room below zero would suggest that a stiffness may be negative.
        if low >= 0.0 && high > 0.0 {
            padded_low = padded_low.max(0.0);
        }
        if high <= 0.0 && low < 0.0 {
            padded_high = padded_high.min(0.0);
        }
        Self { low: padded_low, high: padded_high, step: round_step(padded_high - padded_low, 7.0) }
    }

    /// Where a value lies between the ends, 0 to 1.
    pub(super) fn share(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    /// The ticks, ascending. At most a dozen, whatever the range.
    pub(super) fn ticks(&self) -> Vec<f64> {
        let slack = 1e-9 * (self.high - self.low);
        let first = ((self.low - slack) / self.step).ceil();
        (0..12)
            .map(|i| (first + f64::from(i)) * self.step)
            .take_while(|tick| *tick <= self.high + slack)
            // The product of a tiny count and a step may be -0.
            .map(|tick| if tick.abs() < slack { 0.0 } else { tick })
            .collect()
    }

    /// Labels of the ticks, such as `−400` and `0.25`; for numbers out of hand, `2e6`.
    pub(super) fn labels(&self) -> Vec<String> {
        let largest = self.low.abs().max(self.high.abs());
        let decimals = decimals_of(self.step);
        let plain = largest < 1e5 && decimals <= 5;
        let text = |tick: f64| if plain { format!("{tick:.decimals$}") } else { short_exponent(tick) };
        self.ticks().into_iter().map(|tick| text(tick).replace('-', "\u{2212}")).collect()
    }

    /// Labels of the ticks in engineering form with one suffix for all: `0`, `1M`, `2M`; `0`, `250k`, `500k`.
    pub(super) fn engineering_labels(&self) -> Vec<String> {
        let scales = [(1e12, "T"), (1e9, "G"), (1e6, "M"), (1e3, "k")];
        let (scale, suffix) = scales.into_iter().find(|(scale, _)| self.high >= *scale).unwrap_or((1.0, ""));
        let decimals = decimals_of(self.step / scale);
        let label = |tick: f64| match tick {
            0.0 => "0".to_owned(),
            _ => format!("{:.decimals$}{suffix}", tick / scale),
        };
        self.ticks().into_iter().map(label).collect()
    }
}

/// A value beside a line, to four digits and no more than needed: `19.6`, `0.102`, `−399.9`.
pub(super) fn value_label(value: f64) -> String {
    let size = value.abs();
    if value != 0.0 && !(1e-4..1e6).contains(&size) {
        return short_exponent(value).replace('-', "\u{2212}");
    }
    let digits = if size >= 1.0 { size.log10().floor() as usize } else { 0 };
    let text = format!("{value:.*}", if size < 1.0 { 4 } else { 3usize.saturating_sub(digits) });
    let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    short.replace('-', "\u{2212}")
}

/// The next of 1, 2, 2.5, 5 times a power of ten that cuts `span` into at most `parts`.
fn round_step(span: f64, parts: f64) -> f64 {
    let raw = span / parts;
    let power = 10f64.powf(raw.log10().floor());
    let factor = [1.0, 2.0, 2.5, 5.0].into_iter().find(|f| f * power >= raw * (1.0 - 1e-9)).unwrap_or(10.0);
    factor * power
}

/// How many decimals a multiple of this step needs.
fn decimals_of(step: f64) -> usize {
    let whole = |decimals: &i32| {
        let scaled = step * 10f64.powi(*decimals);
        scaled > 0.5 && (scaled - scaled.round()).abs() < 1e-6
    };
    (0..12).find(whole).unwrap_or(12) as usize
}

fn short_exponent(value: f64) -> String {
    let text = format!("{value:.3e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
    if value == 0.0 { "0".to_owned() } else { format!("{mantissa}e{exponent}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn step_axes_read_well() {
        assert_eq!(Axis::of_progress(4e6).engineering_labels(), ["0", "1M", "2M", "3M", "4M"]);
        assert_eq!(
            Axis::of_progress(1.2e6).engineering_labels(),
            ["0.00M", "0.25M", "0.50M", "0.75M", "1.00M"].map(|l| { if l == "0.00M" { "0" } else { l } })
        );
        assert_eq!(Axis::of_progress(500_000.0).engineering_labels(), ["0", "100k", "200k", "300k", "400k", "500k"]);
        assert_eq!(Axis::of_progress(0.0).engineering_labels().first().map(String::as_str), Some("0"));
    }

    #[test]
    fn value_axes_read_well() {
        assert_eq!(Axis::of_values(-1125.0, -399.0).labels(), ["−1000", "−800", "−600", "−400"]);
        assert_eq!(Axis::of_values(0.09, 0.38).labels(), ["0.10", "0.15", "0.20", "0.25", "0.30", "0.35"]);
        assert_eq!(Axis::of_values(-3e6, 1e6).labels(), ["−3e6", "−2e6", "−1e6", "0", "1e6"]);
    }

    #[test]
    fn degenerate_ranges_have_ticks() {
        for (low, high) in [(0.0, 0.0), (-0.0, 5e-324), (19.6, 19.6), (-1e99, 1e99), (1e-80, 1e-80), (1.0, 1.0 + 1e-15)]
        {
            let axis = Axis::of_values(low, high);
            assert!(axis.low <= low && axis.high >= high && axis.low < axis.high, "{axis:?}");
            assert!((2..=12).contains(&axis.ticks().len()), "{axis:?} has {:?}", axis.ticks());
            let mut labels = axis.labels();
            labels.dedup();
            assert_eq!(labels.len(), axis.ticks().len(), "{labels:?}");
        }
    }

    #[test]
    fn values_are_short() {
        let shown = [19.6, 0.102, -399.9, 0.0, 5.0, 1e-7, 120.0].map(value_label);
        assert_eq!(shown, ["19.6", "0.102", "−399.9", "0", "5", "1e−7", "120"]);
    }
}
