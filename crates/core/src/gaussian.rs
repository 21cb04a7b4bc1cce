//! The diagonal Gaussian.

/// log 2π.
pub const LOG_TWO_PI: f64 = 1.837_877_066_409_345_3;

/// Σ log σ + A/2·log 2π: what the log-probability lacks beside -Σ z²/2.
pub fn log_norm(log_std: &[f32]) -> f64 {
    log_std.iter().map(|&s| f64::from(s)).sum::<f64>() + 0.5 * LOG_TWO_PI * log_std.len() as f64
}

/// The differential entropy in nats: Σ log σ + A/2·(1 + log 2π).
pub fn entropy(log_std: &[f32]) -> f64 {
    log_norm(log_std) + 0.5 * log_std.len() as f64
}
