//! The paper's underactuated hand (section 6 and appendix B): one motor winds three tendons, each of which closes a thumb or
//! a finger of two links against the springs in its joints.
//!
//! ```text
//!        z ▲   palm          finger bases (±25, +35, 0) mm
//!     ═════╪═════  z = 0     thumb base     (0, -35, 0) mm
//!    ⊙     └──▶ y  ⊙  proximal joints
//!     ╲           ╱   50 mm   angle 0: both links 45° outward, a hard stop
//!      ⊙         ⊙  distal joints    angle > 0 closes, to 1.57 rad
//!       ╲       ╱     40 mm   links are capsules of radius 12 mm
//!     thumb   finger1, finger2
//! ```
//!
//! [`HandDescription`] has every number of it that is not designed. The twelve that are ([`HandRange`]) enter the
//! [`TendonHand`] law, which stands between the motor and the joints, or the tendons of [`mjcf`] with [`Drive::NativeTendon`].
//! [`FreeClosing`], [`droop`], [`pinch_band`] and [`PinchLift`] say of a design what can be said without a simulation.
//!
//! [`urdf`] has its links and joints; what is printed and bought for it is in the crate `hwasp-fabrication`.
//!
//! Nothing here needs the engine.
//!
//! ```
//! use hwasp_tasks::hand::{Drive, HandDescription, MjcfOptions, SMALL_CENTRE, TendonHand, TendonHandSettings, mjcf};
//!
//! let hand = HandDescription::default();
//! let law = TendonHand::new(&hand.transmission, &TendonHandSettings::default())?;
//! let tensions = law.tensions(&SMALL_CENTRE, 0.0002, 0.004, &[0.0; 6]); // N
//! assert!(tensions.iter().sum::<f64>() <= 75.0);
//!
//! let drive = Drive::NativeTendon { design: SMALL_CENTRE };
//! let xml = mjcf(&hand, &MjcfOptions { drive, ..MjcfOptions::default() })?;
//! assert!(xml.starts_with("<mujoco"));
//! # Ok::<(), hwasp_tasks::hand::HandError>(())
//! ```

mod closing;
mod description;
mod error;
mod law;
mod mechanism;
mod mjcf;
pub mod names;
mod space;
mod statics;
mod urdf;
mod xml;

pub use closing::{ClosingPoint, FreeClosing, closing_chart, closing_end};
pub use description::{
    FingerDescription, HandDescription, JointDescription, LinkDescription, ObjectDescription, PalmDescription,
    SUBSTEPS, TransmissionDescription,
};
pub use error::{HandError, positive, within};
pub use law::{PalmMotion, TendonHand, TendonHandSettings};
pub use mjcf::{Drive, MjcfOptions, mjcf};
pub use space::{DESIGN_LEN, HandParameter, HandRange, KINDS_LEN, PAPER_HWASP, PAPER_MINIMAL, SEARCHED, SMALL_CENTRE};
pub use statics::{Droop, PinchBand, PinchLift, PinchTension, droop, opening_torques, pinch_band, torque_ratio};
pub use urdf::urdf;
