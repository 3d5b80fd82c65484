//! Random scenes of one to six people: which valleys S3's rule accepts as printed, and which this
//! library does, and how near their straight paths come to anybody.
//!
//! `cargo run --release --example valley_scenes -- [SCENES] [SEED]`, 20,000 scenes unless told
//! otherwise. The exit code is 1 if a path that the library accepted comes nearer to anybody than it
//! must stay away.

use sidestep::valley::{Geometry, Person, Scene};
use sidestep_spec::valley as law;
use std::process::ExitCode;

/// Numbers out of a seed (SplitMix64).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn between(&mut self, least: f64, greatest: f64) -> f64 {
        least + (greatest - least) * (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// S3's robot, with what the readings take for it.
const GEOMETRY: law::Geometry = law::Geometry {
    robot_radius: 0.25,
    safety_distance: 0.3,
    view_half_angle_deg: 35.0,
};

/// One to six people in view, 1.2 to 4.5 m away, with shoulders of 17 to 25 cm, none inside another.
fn scene(random: &mut Random) -> Vec<law::Person> {
    let count = 1 + random.bits() % 6;
    let mut people: Vec<law::Person> = Vec::new();
    while (people.len() as u64) < count {
        let (range, bearing) = (random.between(1.2, 4.5), random.between(-35.0, 35.0));
        // As single precision holds them, so that both look at the same people.
        let single = |x: f64| f64::from(x as f32);
        let person = law::Person {
            lateral: single(range * f64::sin(bearing.to_radians())),
            range: single(range),
            radius: single(random.between(0.17, 0.25)),
        };
        let depth = |p: &law::Person| law::e4(p.lateral, p.range);
        let apart = |other: &law::Person| {
            (other.lateral - person.lateral).hypot(depth(other) - depth(&person))
                > other.radius + person.radius
        };
        if people.iter().all(apart) {
            people.push(person);
        }
    }
    people
}

/// What became of valleys of a kind: accepted, paths that hit somebody, and paths that come nearer
/// than the clearance.
#[derive(Default)]
struct Count {
    accepted: u64,
    hits: u64,
    too_near: u64,
}

impl Count {
    fn add(&mut self, gap: f64) {
        let (body, margin) = (
            GEOMETRY.robot_radius,
            GEOMETRY.robot_radius + GEOMETRY.safety_distance / 2.0,
        );
        self.accepted += 1;
        self.hits += u64::from(gap < body);
        // As printed, a path may be exactly as far away as it must be.
        self.too_near += u64::from(gap < margin);
    }

    fn show(&self, name: &str) {
        let share = |count: u64| 100.0 * count as f64 / self.accepted.max(1) as f64;
        println!(
            "{name:<34} {:>7} accepted, {:>6} hit somebody ({:.1} %), {:>6} too near ({:.1} %)",
            self.accepted,
            self.hits,
            share(self.hits),
            self.too_near,
            share(self.too_near)
        );
    }
}

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let mut number = |usual: u64| arguments.next().map_or(Ok(usual), |text| text.parse());
    let (Ok(scenes), Ok(seed)) = (number(20_000), number(0)) else {
        eprintln!("give a number of scenes and a seed");
        return ExitCode::FAILURE;
    };
    let geometry = Geometry::new(
        GEOMETRY.robot_radius as f32,
        GEOMETRY.safety_distance as f32,
        (GEOMETRY.view_half_angle_deg as f32).to_radians(),
    )
    .expect("within range");
    let mut random = Random(seed);
    let [
        mut printed_between,
        mut printed_beside,
        mut between,
        mut beside,
    ] = [(); 4].map(|()| Count::default());
    // Scenes with a way: as printed, as printed and truly clear, with the equations' own directions
    // as read, and as the library finds them.
    let mut ways = [0_u64; 4];
    for _ in 0..scenes {
        let people = scene(&mut random);
        let is_between = |index: usize| index > 0 && index < people.len();
        let needed = GEOMETRY.robot_radius + GEOMETRY.safety_distance / 2.0;
        let mut way = [false; 4];
        for region in law::regions(&people, &GEOMETRY, true) {
            if region.wide_enough() && region.heading_deg.is_finite() {
                let gap = region.gap(&people);
                let count = if is_between(region.index) {
                    &mut printed_between
                } else {
                    &mut printed_beside
                };
                count.add(gap);
                way[0] = true;
                way[1] |= gap >= needed && region.heading_deg.abs() <= 35.0;
            }
        }
        for region in law::regions(&people, &GEOMETRY, false) {
            way[2] |= region.wide_enough()
                && region.heading_deg.abs() <= 35.0
                && region.gap(&people) >= needed - 1e-9;
        }
        let core: Vec<Person> = people
            .iter()
            .map(|p| Person::new(p.lateral as f32, p.range as f32, p.radius as f32))
            .collect::<Result<_, _>>()
            .expect("people in range");
        let found = Scene::new(&core).expect("at most six");
        for valley in geometry.valleys(&found).iter() {
            // Judged in f64, from outside.
            let path = law::Region {
                index: valley.index,
                available: 0.0,
                least: 0.0,
                lateral: 0.0,
                range: 0.0,
                heading_deg: f64::from(valley.heading.sine()).asin().to_degrees(),
                length: f64::from(valley.length),
                width_deg: 0.0,
            };
            let count = if is_between(valley.index) {
                &mut between
            } else {
                &mut beside
            };
            count.add(path.gap(&people));
            way[3] = true;
        }
        for (count, there) in ways.iter_mut().zip(way) {
            *count += u64::from(there);
        }
    }
    println!("{scenes} scenes of 1 to 6 people, r_r 0.25 m, d 0.3 m, seed {seed}");
    printed_between.show("as printed, between two people:");
    printed_beside.show("as printed, beside the group:");
    between.show("accepted here, between two:");
    beside.show("accepted here, beside the group:");
    let share = |count: u64| 100.0 * count as f64 / scenes.max(1) as f64;
    for (name, count) in [
        "as printed",
        "as printed, where the path is clear and in view",
        "as read, in the equations' own directions",
        "accepted here",
    ]
    .iter()
    .zip(ways)
    {
        println!("scenes with a way, {name}: {:.1} %", share(count));
    }
    if between.too_near + beside.too_near == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
