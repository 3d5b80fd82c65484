//! Chapter `valley`: which ways between people are accepted.

#[cfg(not(kani))]
use super::kani;
use sidestep::valley::{Geometry, Person, Scene};
use sidestep_spec::valley as law;

/// Any person there is, made either way; the square root by its contract.
fn any_person() -> Person {
    let person = if kani::any() {
        Person::at(kani::any(), kani::any(), kani::any())
    } else {
        Person::new(kani::any(), kani::any(), kani::any())
    };
    kani::assume(person.is_ok());
    match person {
        Ok(person) => person,
        Err(_) => unreachable!(),
    }
}

/// Any robot and sensor.
fn any_geometry() -> Geometry {
    let geometry = Geometry::new(kani::any(), kani::any(), kani::any());
    kani::assume(geometry.is_ok());
    match geometry {
        Ok(geometry) => geometry,
        Err(_) => unreachable!(),
    }
}

/// A scene of these people.
fn scene(people: &[Person]) -> Scene {
    match Scene::new(people) {
        Ok(scene) => scene,
        Err(_) => unreachable!(),
    }
}

/// E25 and E26: the share of the greatest speed is a share, for any width and any angle of view.
//= valley.INV-4
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::stub(crate::math::sin, crate::proofs::math::any_sin))]
#[cfg_attr(kani, kani::stub(crate::math::cos, crate::proofs::math::any_cos))]
#[cfg_attr(kani, kani::stub(crate::math::ln, crate::proofs::math::any_ln))]
pub fn share_is_a_share() {
    let geometry = any_geometry();
    let width = kani::any();
    let share = geometry.share(width);
    assert!(law::is_share(share));
    kani::cover!(share > 0.0 && share < 1.0, "between");
    kani::cover!(share == 1.0, "all of it");
    kani::cover!(width.is_nan(), "no number");
}

/// The order in which people are given makes no difference: any three people, any of whose places may
/// be equal. A swap and a turn make up every other order.
//= valley.INV-7
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(8))]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
pub fn order_makes_no_difference() {
    let [one, two, three] = [any_person(), any_person(), any_person()];
    let given = scene(&[one, two, three]);
    for other in [[two, one, three], [two, three, one]] {
        assert!(law::same_for_any_order(&given, &scene(&other)));
    }
    kani::cover!(one.lateral() == two.lateral(), "equal places");
    kani::cover!(one.lateral() > three.lateral(), "out of order");
}
