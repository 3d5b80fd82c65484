//! Chapter `kinematics`: the differential drive.

#[cfg(not(kani))]
use super::kani;
use sidestep::kinematics::{DifferentialDrive, Twist, WheelRates};
use sidestep_spec::kinematics as law;

/// Limited wheels keep the limit, for any rates and any limit.
//= kinematics.INV-3
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn wheels_are_limited() {
    let (right, left, limit) = (kani::any(), kani::any(), kani::any());
    if let Ok(limited) = (WheelRates { right, left }).limited(limit) {
        assert!(law::wheels_within(limited.right, limited.left, limit));
        kani::cover!(limited.right != right, "limited");
        kani::cover!(limited.right == right && right > 1.0, "left alone");
    }
}

/// No motion and no drive makes anything but finite rates, or an error.
//= kinematics.INV-5
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn wheel_rates_are_finite() {
    if let Ok(drive) = DifferentialDrive::new(kani::any(), kani::any()) {
        let twist = Twist {
            speed: kani::any(),
            turn_rate: kani::any(),
        };
        if let Ok(rates) = drive.wheel_rates(twist) {
            assert!(law::finite(rates.right, rates.left));
            kani::cover!(rates.right > 10.0, "turning");
        }
    }
}
