//! The transmission law: by hand numbers, its derivatives, and what it must never do.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_core::{Hardware, Initial, Law};
use hwasp_diff::{GradCheckSettings, gradcheck};
use hwasp_tasks::hand::{
    DESIGN_LEN, FreeClosing, HandDescription, HandError, HandRange, KINDS_LEN, PAPER_HWASP, PalmMotion, SMALL_CENTRE,
    TendonHand, TendonHandSettings, TransmissionDescription, opening_torques,
};
use proptest::prelude::*;

fn hand(tension_limit: f64) -> TendonHand {
    let transmission = TransmissionDescription { tension_limit, ..TransmissionDescription::default() };
    TendonHand::new(&transmission, &TendonHandSettings::default()).unwrap()
}

fn effort(hand: &TendonHand, design: &[f64; DESIGN_LEN], motor: f64, state: [f64; 7]) -> [f64; 7] {
    let mut effort = [f64::NAN; 7];
    // The palm's command is large: the law must not read it.
    hand.effort(design, &[1e3, motor], &state, &mut effort);
    effort
}

fn close(got: [f64; 7], wanted: [f64; 7]) {
    for (got_one, wanted_one) in got.iter().zip(wanted) {
        assert!((got_one - wanted_one).abs() < 1e-12, "{got:?} is not {wanted:?}");
    }
}

/// x + Δx = 4 mm. Thumb: 4 - (10·0.1 + 6·0.05) = 2.7 mm, 13.5 N. First finger: 4 - (5·0.2 + 3·0.3) = 2.1 mm, 10.5 N.
/// Second finger: 4 - (5·1 + 3·0) < 0, slack. Springs: 6 N·mm/rad.
#[test]
fn torques_by_hand() {
    let state = [0.0038, 0.1, 0.05, 0.2, 0.3, 1.0, 0.0];
    let got = effort(&hand(75.0), &SMALL_CENTRE, 0.0002, state);
    let thumb = [13.5 * 0.010 - 0.006 * 2.1, 13.5 * 0.006 - 0.006 * 1.8];
    let first = [10.5 * 0.005 - 0.006 * 2.2, 10.5 * 0.003 - 0.006 * 2.05];
    let second = [-0.006 * 3.0, -0.006 * 1.75];
    close(got, [thumb[0], thumb[1], first[0], first[1], second[0], second[1], 24.0 * 0.008]);
}

/// The same at a limit of 12 N: all tensions are halved, the springs are not.
#[test]
fn the_limit_scales_all_tensions() {
    let state = [0.0038, 0.1, 0.05, 0.2, 0.3, 1.0, 0.0];
    let got = effort(&hand(12.0), &SMALL_CENTRE, 0.0002, state);
    let thumb = [6.75 * 0.010 - 0.006 * 2.1, 6.75 * 0.006 - 0.006 * 1.8];
    let first = [5.25 * 0.005 - 0.006 * 2.2, 5.25 * 0.003 - 0.006 * 2.05];
    let second = [-0.006 * 3.0, -0.006 * 1.75];
    close(got, [thumb[0], thumb[1], first[0], first[1], second[0], second[1], 12.0 * 0.008]);
}

#[test]
fn the_spool_ends_at_its_travel() {
    let hand = hand(1e6);
    let angles = [0.0; 6];
    assert_eq!(hand.tensions(&SMALL_CENTRE, 0.0002, 0.0449, &angles)[0], 5000.0 * 0.045);
    assert_eq!(hand.tensions(&SMALL_CENTRE, -0.0002, 0.0001, &angles), [0.0; 3]);
}

#[test]
fn a_reference_angle_pays_out_tendon() {
    let transmission =
        TransmissionDescription { reference: [0.1, 0.0, 0.0, 0.2], ..TransmissionDescription::default() };
    let hand = TendonHand::new(&transmission, &TendonHandSettings::default()).unwrap();
    let [thumb, first, second] = hand.tensions(&SMALL_CENTRE, 0.0, 0.0, &[0.0; 6]);
    assert!((thumb - 5000.0 * 0.001).abs() < 1e-12 && (first - 5000.0 * 0.0006).abs() < 1e-12 && first == second);
}

/// Where a digit comes to rest in free closing the law leaves no torque on its joints.
#[test]
fn free_closing_is_in_balance() {
    let description = HandDescription::default();
    for travel in [0.004, 0.008] {
        let thumb = FreeClosing::thumb(&description, &PAPER_HWASP, travel);
        let finger = FreeClosing::finger(&description, &PAPER_HWASP, travel);
        let ([a, b], [c, d]) = (thumb.angles, finger.angles);
        let got = effort(&hand(75.0), &PAPER_HWASP, 0.0, [travel, a, b, c, d, c, d]);
        assert!(got[..6].iter().all(|torque| torque.abs() < 1e-12), "{got:?}");
        assert!((got[6] - 0.008 * (thumb.tension + 2.0 * finger.tension)).abs() < 1e-12);
    }
}

/// All tendons taut; some slack; the sum at its limit: every regime apart from the kinks between them.
#[test]
fn reverse_tangent_and_finite_differences_agree() {
    let palms = [(PalmMotion::Vertical, vec![0.001]), (PalmMotion::Spatial, vec![0.001, -0.002, 0.001])];
    for (palm, command) in palms {
        let settings = TendonHandSettings { palm, ..TendonHandSettings::default() };
        let law = Law::new(TendonHand::new(&TransmissionDescription::default(), &settings).unwrap());
        for (travel, angles) in [
            (0.004, [0.1, 0.05, 0.2, 0.3, 0.15, 0.25]),
            (0.004, [0.1, 0.05, 0.2, 0.3, 1.2, 0.6]),
            (0.001, [0.8, 0.5, 0.7, 0.6, 1.2, 0.6]),
            (0.020, [0.4, 0.2, 0.9, 0.3, 0.8, 0.5]),
            (0.020, [0.4, 0.2, 0.9, 0.3, 1.5, 1.5]),
        ] {
            let mut columns = command.clone();
            columns.extend([0.0001, travel]);
            columns.extend(angles);
            let settings = GradCheckSettings { first_step: 1e-3, ..GradCheckSettings::default() };
            for design in [SMALL_CENTRE, HandRange::Large.middle()] {
                let checked = gradcheck(law.program(), &design, &columns, &settings);
                assert!(checked.is_ok(), "travel {travel}, angles {angles:?}: {}", checked.unwrap_err());
            }
        }
    }
}

/// A hand whose springs are too weak everywhere: at the thumb a larger preload suffices, at the fingers springs have to be stiffer.
const WEAK: [f64; DESIGN_LEN] = [0.01, 0.008, 0.006, 0.004, 0.006, 0.004, 0.002, 0.003, 0.5, 0.1, 0.2, 1.0];

fn standing(opening: [f64; KINDS_LEN]) -> TendonHand {
    let settings = TendonHandSettings { opening: Some(opening), ..TendonHandSettings::default() };
    TendonHand::new(&TransmissionDescription::default(), &settings).unwrap()
}

/// 9/6 = 1.5 rad; 2/4 = 0.5 rad; 9/4 = 2.25 N·mm/rad with 4 rad; 2/3 rad is less than there is.
#[test]
fn springs_that_are_too_weak_are_built_as_those_that_suffice() {
    let hand = standing([0.009, 0.002, 0.009, 0.002]);
    let built = hand.as_built(&WEAK);
    let wanted = [0.01, 0.008, 0.006, 0.004, 0.006, 0.004, 0.00225, 0.003, 1.5, 0.5, 4.0, 1.0];
    assert!(built.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-15), "{built:?}");
    let again: [f64; DESIGN_LEN] = built.clone().try_into().unwrap();
    assert!(hand.as_built(&again).iter().zip(&built).all(|(a, b)| (a - b).abs() < 1e-15));
    // The law is that of the hand as it is built.
    let state = [0.0038, 0.1, 0.05, 0.2, 0.3, 1.0, 0.0];
    let free = TendonHand::new(&TransmissionDescription::default(), &TendonHandSettings::default()).unwrap();
    close(effort(&hand, &WEAK, 0.0002, state), effort(&free, &again, 0.0002, state));
    let strong = [0.01, 0.008, 0.006, 0.004, 0.006, 0.004, 0.006, 0.003, 2.0, 0.6, 2.0, 1.0];
    assert_eq!(hand.as_built(&strong), strong);
}

#[test]
fn the_gradient_knows_that_hands_have_to_stand() {
    let law = Law::new(standing([0.009, 0.002, 0.009, 0.002]));
    let columns = [0.001, 0.0001, 0.004, 0.1, 0.05, 0.2, 0.3, 0.15, 0.25];
    let settings = GradCheckSettings { first_step: 1e-3, ..GradCheckSettings::default() };
    for design in [WEAK, SMALL_CENTRE] {
        let checked = gradcheck(law.program(), &design, &columns, &settings);
        assert!(checked.is_ok(), "{}", checked.unwrap_err());
    }
}

/// The torque of gravity about both joints of every digit, written anew, over all poses.
#[test]
fn hands_that_stand_open_stand_at_every_pose() {
    let (hand, margin) = (HandDescription::default(), 0.001);
    let opening = opening_torques(&hand, margin);
    let built = standing(opening).as_built(&WEAK);
    for (digit, first) in [(&hand.thumb, 0), (&hand.fingers[0], 2)] {
        let mut least = f64::INFINITY;
        for (a, b) in
            (0..=30).flat_map(|a| (0..=30).map(move |b| (f64::from(a) * 1.57 / 30.0, f64::from(b) * 1.57 / 30.0)))
        {
            let (lean, tip_lean) = (hand.joint.rest_angle - a, hand.joint.rest_angle - a - b);
            let tip = digit.distal.mass * digit.distal.centre * tip_lean.sin();
            let root =
                (digit.proximal.mass * digit.proximal.centre + digit.distal.mass * digit.proximal.length) * lean.sin();
            for (j, (weight, angle)) in [(root + tip, a), (tip, b)].into_iter().enumerate() {
                let spring = built[4 + first + j] * (angle + built[8 + first + j]);
                least = least.min(spring - 9.81 * weight);
            }
        }
        assert!((least - margin).abs() < 1e-5, "{least} N·m");
    }
}

#[test]
fn ports_are_named_in_the_order_of_the_slices() {
    let ports = hand(75.0).ports();
    assert_eq!(ports.command, ["palm_z", "motor"]);
    assert_eq!((ports.state.len(), &*ports.state[0], &*ports.state[6]), (7, "motor_travel", "finger2_distal_angle"));
    assert_eq!((&*ports.effort[0], &*ports.effort[6]), ("thumb_proximal_torque", "motor_torque"));
}

#[test]
fn impossible_transmissions_are_refused() {
    let transmission = TransmissionDescription { tendon_stiffness: -1.0, ..TransmissionDescription::default() };
    let error = TendonHand::new(&transmission, &TendonHandSettings::default()).unwrap_err();
    assert_eq!(error.to_string(), "transmission.tendon_stiffness = -1 N/m is not a positive finite number");
    let settings = TendonHandSettings { opening: Some([0.1; KINDS_LEN]), ..TendonHandSettings::default() };
    let error = TendonHand::new(&TransmissionDescription::default(), &settings).unwrap_err();
    assert_eq!(error.to_string(), "opening torque = 0.1 N·m is outside of [0, 0.048]; choose it between them");
    let settings = TendonHandSettings { initial: [Initial::Value(1.0); DESIGN_LEN], ..TendonHandSettings::default() };
    let error = TendonHand::new(&TransmissionDescription::default(), &settings).unwrap_err();
    assert!(matches!(error, HandError::Design(_)) && error.to_string().starts_with("thumb_proximal_radius"));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// No tendon pushes, the motor never pulls more than it can, and digits share what there is as their stretch asks.
    #[test]
    fn tensions_stay_within_what_the_motor_can(
        part in prop::collection::vec(0.0..1.0f64, DESIGN_LEN),
        travel in 0.0..0.045f64,
        step in -0.0003..0.0003f64,
        angles in prop::collection::vec(0.0..1.57f64, 6),
    ) {
        let bounds = HandRange::Large.bounds();
        let design: Vec<f64> = bounds.iter().zip(&part).map(|((lo, hi), part)| lo + (hi - lo) * part).collect();
        let limited = hand(75.0).tensions(&design, step, travel, &angles);
        let free = hand(1e9).tensions(&design, step, travel, &angles);
        let (total, wanted) = (limited.iter().sum::<f64>(), free.iter().sum::<f64>().min(75.0));
        prop_assert!((total - wanted).abs() < 1e-9, "{total} N is not {wanted} N");
        for (one, asked) in limited.iter().zip(free) {
            prop_assert!(*one >= 0.0 && *one <= asked);
        }
    }
}
