//! Chapter `valley`: which ways between people are accepted.

#[cfg(not(kani))]
use super::kani;
use sidestep::valley::{self, Geometry, Heading, Person, Region, Scene};
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

/// A way that is admitted keeps clear of everybody: any two people, any robot and sensor, any
/// direction and length. The clearance is that of the check, which is `valley::ROUNDING` more than must
/// be kept. That the predicate is what clearance means is theorem 14a of `spec/smt`.
//= valley.INV-1
//= valley.INV-6
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(8))]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::stub(crate::math::sin, crate::proofs::math::any_sin))]
#[cfg_attr(kani, kani::stub(crate::math::cos, crate::proofs::math::any_cos))]
pub fn admitted_way_is_clear() {
    let geometry = any_geometry();
    let people = [any_person(), any_person()];
    let scene = scene(&people);
    let heading = Heading::new(kani::any());
    let length = kani::any();
    if geometry.admits(&scene, heading, length) {
        for person in people {
            assert!(law::keeps_clear(
                [person.lateral(), person.depth()],
                geometry.clearance(&person) + valley::ROUNDING,
                [heading.sine(), heading.cosine()],
                length,
            ));
        }
        assert!(law::is_defined(
            heading.sine(),
            geometry.view_sine(),
            length
        ));
        kani::cover!(heading.sine() > 0.1, "to the right");
        kani::cover!(people[0].range() < 3.0, "past somebody near");
    }
}

/// Any direction that a search may find, or none.
fn any_direction(_: &Geometry, _: &Scene, _: usize, _: &Region) -> Option<f32> {
    if kani::any() { Some(kani::any()) } else { None }
}

/// An accepted valley was wide enough and is admitted, whatever direction was found for it: beside any
/// person, for any robot and sensor.
//= valley.INV-2
//= valley.INV-6
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(8))]
#[cfg_attr(kani, kani::stub(crate::math::sqrt, crate::proofs::math::any_sqrt))]
#[cfg_attr(kani, kani::stub(crate::math::sin, crate::proofs::math::any_sin))]
#[cfg_attr(kani, kani::stub(crate::math::cos, crate::proofs::math::any_cos))]
#[cfg_attr(kani, kani::stub(crate::math::atan2, crate::proofs::math::any_atan2))]
#[cfg_attr(
    kani,
    kani::stub(
        crate::valley::Geometry::direction,
        crate::proofs::valley::any_direction
    )
)]
pub fn accepted_valley_is_admitted() {
    let geometry = any_geometry();
    let scene = scene(&[any_person()]);
    let index = if kani::any() { 0 } else { 1 };
    let region = geometry.region(&scene, index);
    let valley = geometry.valley(&scene, index);
    assert!(region.is_some());
    if let Some(region) = region {
        assert!(law::decided_by_width(
            region.is_wide_enough(),
            region.available,
            region.least
        ));
        assert!(valley.is_none() || region.is_wide_enough());
    }
    if let Some(valley) = valley {
        assert!(geometry.admits(&scene, valley.heading, valley.length));
        assert!(law::is_defined(
            valley.heading.sine(),
            geometry.view_sine(),
            valley.length
        ));
        kani::cover!(index == 0, "on the left");
        kani::cover!(index == 1, "on the right");
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
