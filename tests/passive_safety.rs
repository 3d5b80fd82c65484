//! The theorem of chapter `shield`, driven: random worlds in which every assumption holds, random
//! laws, and the real view and shield. The robot is at rest before anything touches it.
//!
//! A world is simulated by the millisecond in f64; the robot makes whatever the model allows of its
//! commands, and things do whatever their class allows. `PROPTEST_CASES=25600` is a hundred times as
//! many worlds.

mod common;

use common::{cases, settings, usual_or_any_config};
use proptest::prelude::*;
use sidestep::config::{Config, Parameters};
use sidestep::controller::Controller;
use sidestep::law::{Advice, Law};
use sidestep::observation::{BaseStatus, Observation, OdometrySample, SonarSample};
use sidestep::quantity::Instant;
use sidestep::ring::{Placement, Ring};
use sidestep::shield::Limits;
use sidestep::view::{Class, View};
use std::cell::Cell;
use std::collections::VecDeque;
use std::f64::consts::{PI, TAU};

/// Sonars of every robot here, evenly spaced, with cones that overlap.
const SONARS: usize = 8;

/// A world lasts this long, ms.
const LIFE: usize = 8_000;

/// Numbers out of a seed (splitmix64).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number in [0, 1).
    fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.unit()
    }

    fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// An integer from `least` to `most`.
    fn whole(&mut self, least: i32, most: i32) -> i32 {
        least + (self.bits() % (most - least + 1) as u64) as i32
    }
}

/// What a law is after.
#[derive(Clone, Copy, Debug)]
enum Wish {
    /// Full speed ahead.
    Ahead,
    /// Full speed backward.
    Back,
    /// At the nearest thing.
    Chase,
    /// Anything, another thing every now and then.
    Anything,
}

/// A law that says what it is told to.
struct Told(Cell<Advice>);

impl Law<SONARS> for Told {
    fn advise(&mut self, _view: &View<SONARS>) -> Advice {
        self.0.get()
    }

    fn mode(&self) -> &'static str {
        "told"
    }
}

/// Where the robot was, and how it moved: m, rad, m/s, rad/s.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    at: [f64; 2],
    heading: f64,
    speed: f64,
    turn_rate: f64,
}

/// What a thing does.
#[derive(Clone, Copy, Debug)]
enum Habit {
    /// It goes for the robot.
    Charges,
    /// It goes straight on.
    Crosses,
    /// It stands, and goes for the robot every now and then.
    Lurks,
    /// It never moves.
    Stands,
}

/// A thing: a point.
#[derive(Clone, Copy, Debug)]
struct Thing {
    at: [f64; 2],
    direction: f64,
    habit: Habit,
    /// The share of its greatest speed at which it goes.
    haste: f64,
    /// It moves like a still thing until then, ms: it is taken for one.
    still_until: usize,
}

/// The base between two commands, as the model has it.
struct Base {
    /// Speed bound u until the command takes effect, m/s.
    bound: f64,
    /// When the command was given, what it is, and when it takes effect (ms): m/s, rad/s.
    command: [f64; 2],
    effective: usize,
    /// The command that is in force.
    target: [f64; 2],
    /// Greatest speed in the direction of the command in force, m/s.
    ceiling: f64,
    /// It goes to the ceiling, not to the target.
    hasty: bool,
}

/// How a world went.
#[derive(Clone, Copy, Debug, Default)]
struct Report {
    /// Contacts while the robot drove or turned.
    moving: u32,
    /// Contacts while it stood.
    at_rest: u32,
    /// Way, m.
    way: f64,
    /// Ticks at which something counted as still.
    still: u32,
    /// Ticks at which the robot drove backward.
    backward: u32,
}

impl Report {
    fn add(&mut self, other: &Self) {
        self.moving += other.moving;
        self.at_rest += other.at_rest;
        self.way += other.way;
        self.still += other.still;
        self.backward += other.backward;
    }
}

/// A configuration and a ring that sees all round, out of what a configuration asks for.
fn all_round(config: &Config, random: &mut Random) -> (Config, Ring<SONARS>) {
    let mut p = Parameters {
        sonar_half_angle: random.between(0.45, 0.8) as f32,
        sonar_range_max: 20.0,
        sonar_range_min: 0.0,
        blind_angle_max: 0.0,
        ..*config.parameters()
    };
    // Things do not go beyond hearing, and do not vanish: nothing is said about memory that ends.
    // An echo that is lost once is not forgotten before the next.
    p.hold_time = p.hold_time.max(2.0 * p.reaction_time + 0.5);
    p.sonar_age_max = p.sonar_age_max.max(1.0);
    p.odometry_age_max = p.odometry_age_max.max(p.reaction_time);
    // The rule of S1 stops it long before the guard does; without it the guard is alone.
    if random.chance(0.7) {
        p.stop_time = 0.0;
        p.min_distance = 0.03;
        p.turn_distance = p.turn_distance.min(0.06);
    }
    if random.chance(0.5) {
        p.resume_samples = 1.0;
        p.resume_clearance = 0.0;
    }
    // From the middle, or from half way out where cones are wide enough to meet before the hull.
    let out = if p.sonar_half_angle > 0.79 {
        random.between(0.0, 0.45 * f64::from(p.robot_radius))
    } else {
        0.0
    };
    let placements = std::array::from_fn(|i| {
        let bearing = TAU * i as f64 / SONARS as f64;
        let heading = if bearing > PI { bearing - TAU } else { bearing };
        Placement {
            x: (out * heading.cos()) as f32,
            y: (out * heading.sin()) as f32,
            heading: heading as f32,
        }
    });
    let config = Config::new(p).expect("within every range");
    settings::fitted_to(&placements, &config)
}

/// One world.
struct World {
    random: Random,
    config: Config,
    ring: Ring<SONARS>,
    limits: Limits,
    controller: Controller<Told, SONARS>,
    wish: Wish,
    now: usize,
    /// By the millisecond.
    past: Vec<State>,
    things: Vec<Thing>,
    base: Base,
    /// From a command to its effect, ms, and the age of odometry.
    delay: usize,
    odometry_age: usize,
    /// How late echoes are at most, ms: only where the classes are one.
    late: usize,
    dropped: [bool; SONARS],
    /// How many times faster than promised things are.
    too_fast: f64,
    touching: Vec<bool>,
    report: Report,
}

impl World {
    fn new(config: &Config, seed: u64, too_fast: f64) -> Self {
        let mut random = Random(seed);
        let (mut config, mut ring) = all_round(config, &mut random);
        let mut late = 0;
        if random.chance(0.3) {
            late = random.whole(0, 400) as usize;
            let mut p = *config.parameters();
            p.still_speed_max = p.obstacle_speed_max;
            p.still_speed_max_turning = p.obstacle_speed_max;
            config = Config::new(p).expect("still in range");
            ring = Ring::new(&std::array::from_fn(|i| placement_of(&ring, i)), &config)
                .expect("the same ring");
        }
        let limits = Limits::new(&config);
        let goal = [900.0, 0.0].into();
        let law = Told(Cell::new(Advice::REST));
        let controller = Controller::new(config, ring, law, goal).expect("a goal in range");
        let wishes = [Wish::Ahead, Wish::Back, Wish::Chase, Wish::Anything];
        let wish = wishes[random.whole(0, 3) as usize];
        let radius = f64::from(config.robot_radius);
        let habits = [Habit::Charges, Habit::Crosses, Habit::Lurks, Habit::Stands];
        let count = random.whole(1, 3);
        let things: Vec<_> = (0..count)
            .map(|_| {
                let bearing = random.between(-PI, PI);
                let away = radius + random.between(0.02, 1.0) * random.between(0.2, 4.0);
                Thing {
                    at: [away * bearing.cos(), away * bearing.sin()],
                    direction: random.between(-PI, PI),
                    habit: habits[random.whole(0, 3) as usize],
                    haste: if random.chance(0.6) {
                        1.0
                    } else {
                        random.unit()
                    },
                    still_until: 0,
                }
            })
            .collect();
        let third = limits.reaction_time() / 3;
        Self {
            delay: random.whole(0, third) as usize,
            odometry_age: random.whole(0, third) as usize,
            touching: vec![false; things.len()],
            base: Base {
                bound: 0.0,
                command: [0.0; 2],
                effective: 0,
                target: [0.0; 2],
                ceiling: 0.0,
                hasty: random.chance(0.5),
            },
            random,
            config,
            ring,
            limits,
            controller,
            wish,
            now: 1_000,
            past: vec![State::default(); 1_001],
            things,
            late,
            dropped: [false; SONARS],
            too_fast,
            report: Report::default(),
        }
    }

    fn state(&self) -> &State {
        self.past.last().expect("a beginning")
    }

    /// The range and bearing off the axis at which a sonar has a point, of a robot in a state.
    fn seen_by(&self, sonar: usize, state: &State, point: [f64; 2]) -> (f64, f64) {
        let sonar = &self.ring.sonars()[sonar];
        let (sin, cos) = state.heading.sin_cos();
        let (x, y) = (f64::from(sonar.position.x), f64::from(sonar.position.y));
        let face = [
            state.at[0] + cos * x - sin * y,
            state.at[1] + sin * x + cos * y,
        ];
        let to = [point[0] - face[0], point[1] - face[1]];
        let axis = state.heading + f64::from(sonar.heading.get());
        let off = sidestep_spec::avoid::wrap(to[1].atan2(to[0]) - axis);
        (to[0].hypot(to[1]), off.abs())
    }

    fn half_angle(&self) -> f64 {
        f64::from(self.config.sonar_half_angle)
    }

    /// What a sonar measures, with errors as promised; seldom nothing, and not twice in a row.
    fn measure(&mut self, sonar: usize) -> f32 {
        self.dropped[sonar] = !self.dropped[sonar] && self.now > 1_200 && self.random.chance(0.03);
        if self.dropped[sonar] {
            return self.config.sonar_range_max;
        }
        let mut nearest = f64::from(self.config.sonar_range_max);
        for thing in &self.things {
            let (range, off) = self.seen_by(sonar, self.state(), thing.at);
            if off <= self.half_angle() {
                nearest = nearest.min(range);
            }
        }
        let error = f64::from(self.config.range_error);
        let error = match self.random.whole(0, 3) {
            0 => error,
            1 => -error,
            _ => self.random.between(-error, error),
        };
        ((nearest + error).max(0.001) as f32).min(self.config.sonar_range_max)
    }

    /// What the sensors say now. `echoes` were measured a while ago.
    fn observe(&mut self, echoes: &[(f32, usize); SONARS]) -> Observation<SONARS> {
        let at = self.now - self.odometry_age;
        let state = self.past[at];
        let error = self.random.unit() * f64::from(self.config.speed_error);
        let measured = match state.speed {
            0.0 => 0.0,
            // Wheels that turn are measured as turning.
            speed => (speed.abs() - error).max(0.0005).copysign(speed),
        };
        Observation {
            now: Instant(self.now as u64),
            sonar: echoes.map(|(range, taken_at)| {
                Some(SonarSample {
                    range,
                    taken_at: Instant(taken_at as u64),
                })
            }),
            odometry: Some(OdometrySample {
                x: state.at[0] as f32,
                y: state.at[1] as f32,
                heading: state.heading as f32,
                speed: measured as f32,
                turn_rate: state.turn_rate as f32,
                taken_at: Instant(at as u64),
            }),
            sighting: None,
            base: BaseStatus {
                motors_enabled: true,
                stalled: false,
                emergency_stop: false,
            },
        }
    }

    fn advise(&mut self) {
        let nearest = self.things.iter().min_by(|a, b| {
            let away = |thing: &Thing| {
                let at = self.state().at;
                (thing.at[0] - at[0]).hypot(thing.at[1] - at[1])
            };
            away(a).total_cmp(&away(b))
        });
        let state = *self.state();
        let advice = match (self.wish, nearest) {
            (Wish::Back, _) => [-2.0, 0.0],
            (Wish::Chase, Some(thing)) => {
                let bearing = (thing.at[1] - state.at[1]).atan2(thing.at[0] - state.at[0]);
                let off = sidestep_spec::avoid::wrap(bearing - state.heading);
                [2.0, 3.0 * off]
            }
            (Wish::Anything, _) => {
                if self.random.chance(0.9) && self.now > 1_200 {
                    return;
                }
                [
                    self.random.between(-2.0, 2.0),
                    self.random.between(-4.0, 4.0) * f64::from(self.random.whole(0, 1)),
                ]
            }
            _ => [2.0, 0.0],
        };
        self.controller.law().0.set(Advice {
            speed: advice[0] as f32,
            turn_rate: advice[1] as f32,
        });
    }

    /// A tick of the controller on what was measured at a time.
    fn tick(&mut self, echoes: &[(f32, usize); SONARS]) {
        self.advise();
        if self.random.chance(0.2) {
            self.controller.reset();
        }
        let last = self.base.command[0];
        let observation = self.observe(echoes);
        let decision = self.controller.tick(&observation);
        let view = decision.view.expect("odometry");
        self.take_for_still(&view);
        let (speed, turn_rate) = (decision.command.speed(), decision.command.turn_rate());
        self.report.backward += u32::from(speed < 0);
        // u of the model: no faster than that until this command takes effect.
        let gained = f64::from(self.limits.acceleration()) * self.odometry_age as f64 / 1e6;
        let measured = f64::from(view.speed.abs()) + f64::from(self.config.speed_error) + gained;
        let bound = if view.speed == 0.0 && last == 0.0 {
            0.0
        } else {
            measured.max(last.abs())
        };
        self.base.bound = bound;
        self.base.command = [f64::from(speed) / 1000.0, f64::from(turn_rate) / 1000.0];
        self.base.effective = self.now + self.delay;
    }

    /// Whatever is in a cone whose thing counts as still moves like a still thing for as long as
    /// what was decided on it may last.
    fn take_for_still(&mut self, view: &View<SONARS>) {
        let lasts = self
            .limits
            .time_to_rest(self.limits.speed_max() + self.limits.speed_gain());
        let until = self.now + lasts as usize;
        let state = *self.state();
        for sonar in 0..SONARS {
            if view.hazard[sonar].class != Class::Still {
                continue;
            }
            self.report.still += 1;
            for i in 0..self.things.len() {
                let (_, off) = self.seen_by(sonar, &state, self.things[i].at);
                // A little more than the cone: it turns with the robot until the next tick.
                if off <= self.half_angle() + 0.05 {
                    self.things[i].still_until = until;
                }
            }
        }
    }

    /// Robot and things move on by a millisecond.
    fn millisecond(&mut self) {
        self.now += 1;
        let mut state = *self.state();
        self.move_robot(&mut state);
        self.past.push(state);
        self.report.way += state.speed.abs() / 1000.0;
        let (at, radius) = (state.at, f64::from(self.config.robot_radius));
        for i in 0..self.things.len() {
            self.move_thing(i, at);
            let thing = self.things[i].at;
            let touches = (thing[0] - at[0]).hypot(thing[1] - at[1]) < radius - 1e-6;
            if touches && !self.touching[i] {
                let moves = state.speed != 0.0 || state.turn_rate != 0.0;
                self.report.moving += u32::from(moves);
                self.report.at_rest += u32::from(!moves);
            }
            self.touching[i] = touches;
        }
    }

    fn move_robot(&mut self, state: &mut State) {
        let limits = &self.limits;
        let a = f64::from(limits.acceleration()) / 1000.0;
        let b = f64::from(limits.braking()) / 1000.0;
        let alpha = f64::from(limits.turn_acceleration()) / 1000.0;
        let base = &mut self.base;
        if self.now > base.effective && base.effective > 0 {
            base.effective = 0;
            base.target = base.command;
            let gain = f64::from(limits.speed_gain()) / 1000.0;
            base.ceiling = if base.target[0] == 0.0 {
                0.0
            } else {
                (base.target[0].abs() + gain).max(base.bound)
            };
        }
        let most = f64::from(limits.speed_max()) / 1000.0;
        let target = base.target[0];
        let same = target == 0.0 || state.speed == 0.0 || (target < 0.0) == (state.speed < 0.0);
        let mut wanted = match (target, base.hasty) {
            (0.0, _) => 0.0,
            (_, true) => state
                .speed
                .abs()
                .max(base.ceiling)
                .min(most.max(state.speed.abs())),
            (_, false) => target.abs(),
        };
        if base.effective > 0 {
            // Until the command takes effect it gains nothing beyond u.
            wanted = wanted.min(base.bound);
        }
        let sign = if state.speed == 0.0 {
            target
        } else {
            state.speed
        };
        let size = state.speed.abs();
        let size = if !same || size > wanted {
            (size - b / 1000.0).max(if same { wanted } else { 0.0 })
        } else {
            (size + a / 1000.0).min(wanted)
        };
        state.speed = if size == 0.0 {
            0.0
        } else {
            size.copysign(sign)
        };
        let turn = base.target[1] - state.turn_rate;
        state.turn_rate += turn.clamp(-alpha / 1000.0, alpha / 1000.0);
        state.heading = sidestep_spec::avoid::wrap(state.heading + state.turn_rate / 1000.0);
        state.at[0] += state.speed / 1000.0 * state.heading.cos();
        state.at[1] += state.speed / 1000.0 * state.heading.sin();
    }

    fn move_thing(&mut self, i: usize, robot: [f64; 2]) {
        let class = if self.things[i].still_until >= self.now {
            Class::Still
        } else {
            Class::Unknown
        };
        let most = f64::from(self.limits.class_speed(class)) / 1000.0 * self.too_fast;
        let lurks = self.random.chance(0.001);
        let thing = &mut self.things[i];
        let at_robot = (robot[1] - thing.at[1]).atan2(robot[0] - thing.at[0]);
        let speed = match thing.habit {
            Habit::Stands => 0.0,
            Habit::Crosses => thing.haste * most,
            Habit::Charges => {
                thing.direction = at_robot;
                thing.haste * most
            }
            Habit::Lurks => {
                if lurks {
                    thing.haste = f64::from(thing.haste == 0.0);
                }
                thing.direction = at_robot;
                thing.haste * most
            }
        };
        thing.at[0] += speed / 1000.0 * thing.direction.cos();
        thing.at[1] += speed / 1000.0 * thing.direction.sin();
    }

    /// From the beginning to the end, or to the first contact: what touches the robot may be where no
    /// sonar looks.
    fn live(mut self) -> Report {
        let reaction = self.limits.reaction_time() as usize;
        let shortest = self.delay.max(self.odometry_age).max(1);
        let longest = reaction - self.delay - self.odometry_age;
        let mut heard = VecDeque::new();
        while self.now < LIFE {
            let ranges: [f32; SONARS] = std::array::from_fn(|sonar| self.measure(sonar));
            heard.push_back((ranges, self.now));
            // The newest that are late enough.
            let late = self.random.whole(0, self.late as i32) as usize;
            while heard.len() > 1 && heard[1].1 + late <= self.now {
                heard.pop_front();
            }
            let (ranges, taken_at) = heard[0];
            self.tick(&ranges.map(|range| (range, taken_at)));
            let period = self
                .random
                .whole(shortest as i32, longest.max(shortest) as i32);
            for _ in 0..period {
                self.millisecond();
                if self.touching.contains(&true) {
                    return self.report;
                }
            }
        }
        self.report
    }
}

fn placement_of(ring: &Ring<SONARS>, i: usize) -> Placement {
    let sonar = &ring.sonars()[i];
    Placement {
        x: sonar.position.x,
        y: sonar.position.y,
        heading: sonar.heading.get(),
    }
}

proptest! {
    #![proptest_config(cases(1_500))]

    //= shield.INV-3
    //= shield.INV-9
    //= view.INV-5
    #[test]
    fn at_rest_before_contact(config in usual_or_any_config(), seed in any::<u64>()) {
        let report = World::new(&config, seed, 1.0).live();
        prop_assert_eq!(report.moving, 0, "{:?}", report);
    }
}

/// The same worlds are not empty: robots drive, backward too, things count as still and touch robots
/// that stand; and where things are three times as fast as promised, robots that move are touched.
//= shield.INV-3
#[test]
fn the_worlds_are_not_empty() {
    let config = common::pioneer();
    let through = |too_fast| {
        let mut all = Report::default();
        for seed in 0..300 {
            all.add(&World::new(&config, seed, too_fast).live());
        }
        println!("things {too_fast} times as fast as promised: {all:?}");
        all
    };
    let promised = through(1.0);
    assert_eq!(promised.moving, 0);
    assert!(promised.way > 30.0 && promised.at_rest > 30);
    assert!(promised.still > 1_000 && promised.backward > 100);
    assert!(through(3.0).moving > 0);
}
