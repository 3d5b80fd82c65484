//! Chapter `interact`: the machine M2, and the law among people that it is shown.

mod common;

use common::{angle, any_f32, cases, pioneer, point, view};
use nalgebra::Vector2;
use proptest::prelude::*;
use proptest::sample::select;
use sidestep::config::Config;
use sidestep::gesture::{self, Gesture, PEOPLE_MAX, Skeleton};
use sidestep::interact::{
    self, Announcement, Choice, Commissioned, CommissioningError, Drive, Event, FIELDS, Frame,
    Interact, LateralAxis, Order, Orders, Parameters, Path, People, Settings, Situation, Someone,
    State, Trial, USUAL,
};
use sidestep::law::{Advice, Law};
use sidestep::math;
use sidestep::observation::{BaseStatus, SonarReading};
use sidestep::quantity::{Angle, Instant, Length};
use sidestep::valley::Side;
use sidestep::view::{Class, GoalView, Hazard, Pose, View};
use sidestep_spec::interact as law;

fn settings() -> Settings {
    Settings::new(USUAL, &pioneer()).expect("the usual values are good")
}

const FRAME: Frame = Frame {
    lateral_axis: LateralAxis::Left,
    orders: Orders::Persons,
};

fn commissioned() -> Commissioned {
    FRAME
        .commissioned(&Trial {
            stood: Side::Right,
            lateral: -0.7,
            gesture: Gesture::Right,
            meant: Side::Left,
        })
        .expect("the trial bears it out")
}

// ------------------------------------------------------------------- machine

fn path() -> impl Strategy<Value = Path> {
    (point(), angle(), 0.1_f32..10.0, 0.0_f32..1.0, 0.0_f32..1.0).prop_map(
        |(from, heading, length, speed, turn_rate)| {
            Path::new(from, heading, length, speed, turn_rate).expect("a path")
        },
    )
}

fn side() -> impl Strategy<Value = Side> {
    select(&[Side::Left, Side::Right][..])
}

fn gesture() -> impl Strategy<Value = Gesture> {
    select(&Gesture::ALL[..])
}

fn state() -> impl Strategy<Value = State> {
    let choice = prop_oneof![Just(Choice::Waypoint), side().prop_map(Choice::Side)];
    prop_oneof![
        select(
            &[
                State::Follow,
                State::Announce,
                State::Stop,
                State::AskInteract,
                State::Wait,
                State::Master,
                State::Resume,
                State::NoFreePath,
                State::Arrived,
            ][..]
        ),
        choice.prop_map(State::Plan),
        path().prop_map(State::Rotate),
        path().prop_map(State::Traverse),
    ]
}

fn situation() -> impl Strategy<Value = Situation> {
    let often = || prop::bool::weighted(0.8);
    let seldom = || prop::bool::weighted(0.1);
    let order = (
        proptest::option::of(gesture()),
        proptest::option::of(side()),
        angle(),
        any_f32(),
    );
    let order = order.prop_map(|(gesture, side, bearing, nearest_ahead)| Order {
        gesture,
        side,
        bearing,
        nearest_ahead,
    });
    (
        (seldom(), often(), seldom()),
        [any::<bool>(), any::<bool>(), any::<bool>(), any::<bool>()],
        (any::<bool>(), proptest::option::of(order), any::<bool>()),
        proptest::option::of(path()),
        [any::<bool>(), any::<bool>(), any::<bool>()],
    )
        .prop_map(
            |((at_goal, camera, stop_shown), ways, (master, order, overdue), plan, flags)| {
                let [in_path, near, path_free, at_rest] = ways;
                let [aligned, passed, intruded] = flags;
                Situation {
                    at_goal,
                    camera,
                    stop_shown,
                    in_path,
                    near,
                    path_free,
                    at_rest,
                    master,
                    order,
                    overdue,
                    plan,
                    aligned,
                    passed,
                    intruded,
                }
            },
        )
}

proptest! {
    #![proptest_config(cases(20_000))]

    //= interact.INV-1
    //= interact.INV-2
    //= interact.INV-3
    //= interact.INV-4
    //= interact.INV-8
    #[test]
    fn machine_keeps_its_promises(state in state(), now in situation(), rear in any::<bool>()) {
        let settings = settings();
        let next = interact::next_state(&state, &now);
        let asked = interact::drive(&next, &now, settings.forward_distance, rear);
        let demanded = now.stop_shown || !now.camera;
        prop_assert!(law::stop_is_obeyed(demanded, asked == Drive::Rest));
        // From every state in which the robot moves a stop leads to one in which it does not, or to
        // a master's, which asks for nothing.
        prop_assert!(law::stop_is_obeyed(
            demanded, !next.moves() || (state == State::Master && next == State::Master)
        ));
        let found = if matches!(state, State::Plan(_)) { now.plan } else { None };
        prop_assert!(law::only_planned(state.path(), found.as_ref(), next.path()));
        prop_assert!(
            !matches!(asked, Drive::Turn(_) | Drive::Along(_)) || next.path().is_some()
        );
        let shown = now.order.and_then(|order| order.gesture);
        prop_assert!(law::leads_only_while_shown(
            [matches!(asked, Drive::Forward(_)), asked == Drive::Backward],
            [shown == Some(Gesture::Forward), shown == Some(Gesture::Backward)],
            now.order.map_or(0.0, |order| order.nearest_ahead),
            settings.forward_distance,
            rear,
        ));
        let left = std::mem::discriminant(&next) != std::mem::discriminant(&state);
        let waits = matches!(
            state,
            State::Wait | State::NoFreePath | State::Master | State::Rotate(_) | State::Traverse(_)
        ) && !(state == State::Master && demanded);
        prop_assert!(law::ends_in_time(waits, now.overdue, left));
        prop_assert!(law::arrived_for_good(state == State::Arrived, next == State::Arrived));
    }

    /// A frame is taken into use only if the trial bears it out, and every refusal has its reason.
    //= interact.INV-6
    #[test]
    fn only_what_is_borne_out_is_used(
        axis in select(&[LateralAxis::Left, LateralAxis::Right][..]),
        orders in select(&[Orders::Robots, Orders::Persons][..]),
        stood in side(), lateral in any_f32(), gesture in gesture(), meant in side(),
    ) {
        let frame = Frame { lateral_axis: axis, orders };
        let trial = Trial { stood, lateral, gesture, meant };
        let seen = frame.left(lateral) > 0.0;
        match frame.commissioned(&trial) {
            Ok(_) => {
                let sent = frame.side(gesture).expect("an order");
                prop_assert!(law::borne_out(
                    seen, stood == Side::Left, sent == Side::Left, meant == Side::Left
                ));
                // The other reading of either is refused by the same trial.
                let other_axis = match axis {
                    LateralAxis::Left => LateralAxis::Right,
                    LateralAxis::Right => LateralAxis::Left,
                };
                let other = Frame { lateral_axis: other_axis, orders };
                prop_assert_eq!(other.commissioned(&trial), Err(CommissioningError::LateralAxis));
                let other_orders = match orders {
                    Orders::Robots => Orders::Persons,
                    Orders::Persons => Orders::Robots,
                };
                let other = Frame { lateral_axis: axis, orders: other_orders };
                prop_assert_eq!(other.commissioned(&trial), Err(CommissioningError::Orders));
            }
            Err(CommissioningError::NotAside(_)) => {
                prop_assert!(!(0.3..=10.0).contains(&lateral.abs()));
            }
            Err(CommissioningError::LateralAxis) => prop_assert!(seen != (stood == Side::Left)),
            Err(CommissioningError::NoOrder(shown)) => {
                prop_assert!(!matches!(shown, Gesture::Right | Gesture::Left));
            }
            Err(CommissioningError::Orders) => prop_assert!(frame.side(gesture) != Some(meant)),
        }
    }
}

// ------------------------------------------------------------ any input at all

fn someone() -> impl Strategy<Value = Someone> {
    let place = || prop_oneof![6 => -2.0_f32..2.0, 1 => any_f32()];
    let depth = prop_oneof![6 => 0.3_f32..5.0, 1 => any_f32()];
    let radius = proptest::option::of(prop_oneof![3 => 0.1_f32..0.4, 1 => any_f32()]);
    let shown = prop_oneof![2 => Just(None), 3 => gesture().prop_map(Some)];
    (0..5_u64, place(), depth, radius, shown).prop_map(|(id, lateral, depth, radius, gesture)| {
        Someone {
            id,
            lateral,
            depth,
            radius,
            gesture,
        }
    })
}

/// Any picture, of about this time.
fn people(now: u64) -> impl Strategy<Value = People> {
    let time = prop_oneof![
        6 => Just(now),
        3 => now.saturating_sub(600)..=now,
        1 => any::<u64>(),
    ];
    let places = proptest::array::uniform6(proptest::option::of(someone()));
    (time, places).prop_map(|(taken_at, people)| People {
        taken_at: Instant(taken_at),
        people,
    })
}

proptest! {
    #![proptest_config(cases(300))]

    /// Any views and any pictures: the advice is within its limits, and while the picture in force
    /// shows Stop, or there is none, nothing moves.
    //= interact.INV-1
    //= interact.INV-5
    #[test]
    fn any_pictures_give_advice_in_range(
        steps in proptest::collection::vec((view::<1>(), people(0), 0..3_u8), 1..80),
    ) {
        let config = pioneer();
        let settings = settings();
        let mut law_of_s3 = Interact::new(settings, config, commissioned(), true);
        let mut now = 10_000;
        let mut latest: Option<People> = None;
        for (mut view, mut picture, kind) in steps {
            now += 100;
            view.now = Instant(now);
            if kind > 0 {
                // Most pictures are of now; some are from any time.
                if kind > 1 {
                    picture.taken_at = Instant(now - 50);
                }
                law_of_s3.observe_people(&picture);
                if latest.is_none_or(|latest| picture.taken_at > latest.taken_at) {
                    latest = Some(picture);
                }
            }
            let advice = law_of_s3.advise(&view);
            prop_assert!(law::advice_in_range(
                advice.speed,
                advice.turn_rate,
                config.speed_max,
                config.reverse_speed_max,
                config.turn_rate_max,
            ), "{advice:?}");
            let age_max = (settings.camera_age_max * 1000.0) as u64;
            let recent = latest.filter(|latest| {
                view.now.since(latest.taken_at).is_some_and(|age| age <= age_max)
            });
            // Whoever shows Stop at a place where somebody can be, under a number of their own.
            let shows_stop = recent.is_some_and(|picture| {
                let there = |someone: &&Someone| {
                    someone.lateral.abs() <= settings.view_range_max
                        && (0.0..=settings.view_range_max).contains(&someone.depth)
                };
                let all: Vec<&Someone> = picture.people.iter().flatten().filter(there).collect();
                all.iter().any(|someone| {
                    someone.gesture == Some(Gesture::Stop)
                        && all.iter().filter(|other| other.id == someone.id).count() == 1
                })
            });
            prop_assert!(law::stop_is_obeyed(
                recent.is_none() || shows_stop,
                advice.speed == 0.0 && advice.turn_rate == 0.0,
            ));
            prop_assert!(!Law::<1>::mode(&law_of_s3).is_empty());
            if kind == 0 {
                while law_of_s3.next_event().is_some() {}
            }
        }
    }

    /// What is refused is named, and every single parameter is checked.
    #[test]
    fn settings_are_checked(field in 0..FIELDS.len(), value in any_f32()) {
        let mut values = USUAL.values();
        values[field] = value;
        match Settings::new(Parameters::from_values(values), &pioneer()) {
            Ok(settings) => {
                let known = &FIELDS[field];
                prop_assert!((known.min..=known.max).contains(&settings.values()[field]));
            }
            Err(error) => {
                prop_assert!(!(error.min..=error.max).contains(&error.value));
                prop_assert!(!error.field.is_empty());
            }
        }
    }
}

// --------------------------------------------------------------------- stories

/// A robot that does at once whatever the law says, and people as the camera has them.
struct Stage {
    law: Interact,
    now: u64,
    pose: Pose,
    goal: Vector2<f32>,
    advice: Advice,
    /// Number, place in the world (m), gesture.
    people: Vec<(u64, Vector2<f32>, Option<Gesture>)>,
    events: Vec<Event>,
    camera: bool,
}

impl Stage {
    fn new(people: &[[f32; 2]]) -> Self {
        Self::with(settings(), &pioneer(), people)
    }

    fn with(settings: Settings, config: &Config, people: &[[f32; 2]]) -> Self {
        Self {
            law: Interact::new(settings, *config, commissioned(), true),
            now: 1_000,
            pose: Pose {
                position: Vector2::new(0.0, 0.0),
                heading: Angle::ZERO,
            },
            goal: Vector2::new(7.0, 0.0),
            advice: Advice::REST,
            people: people
                .iter()
                .zip(1..)
                .map(|(at, id)| (id, Vector2::new(at[0], at[1]), None))
                .collect(),
            events: Vec::new(),
            camera: true,
        }
    }

    fn view(&self) -> View<1> {
        let to_goal = self.goal - self.pose.position;
        View {
            now: Instant(self.now),
            pose: self.pose,
            speed: self.advice.speed,
            turn_rate: self.advice.turn_rate,
            odometry_age: 0,
            goal: GoalView {
                heading: Angle::radians(to_goal.y.atan2(to_goal.x)).expect("a heading"),
                distance: math::norm(to_goal),
            },
            sonar: [SonarReading::NoEcho(Length::MAX)],
            hazard: [Hazard {
                range: 4_000,
                clearance: 4_000,
                age: 0,
                way: [0; 2],
                turned: 0,
                class: Class::Unknown,
                too_fast: false,
                stuck: false,
            }],
            obstacle: None,
            ahead: Length::MAX,
            room: [Length::MAX; 2],
            beside: [Length::MAX; 2],
            base: BaseStatus {
                motors_enabled: true,
                stalled: false,
                emergency_stop: false,
            },
            guard: None,
        }
    }

    /// What the camera sees from here.
    fn picture(&self) -> People {
        let mut people = [None; PEOPLE_MAX];
        let inside = |at: &Vector2<f32>| {
            let place = self.pose.to_robot(*at);
            (0.5..4.5).contains(&math::norm(place)) && place.y.abs() <= place.x * 0.7
        };
        let seen = self.people.iter().filter(|(_, at, _)| inside(at));
        for (place, (id, at, gesture)) in people.iter_mut().zip(seen) {
            let at = self.pose.to_robot(*at);
            *place = Some(Someone {
                id: *id,
                lateral: at.y,
                depth: at.x,
                radius: None,
                gesture: *gesture,
            });
        }
        People {
            taken_at: Instant(self.now),
            people,
        }
    }

    fn tick(&mut self) -> Advice {
        self.now += 100;
        if self.camera {
            let picture = self.picture();
            self.law.observe_people(&picture);
        }
        let view = self.view();
        self.advice = self.law.advise(&view);
        while let Some(event) = self.law.next_event() {
            self.events.push(event);
        }
        let heading = self.pose.heading.get() + self.advice.turn_rate * 0.1;
        self.pose.heading = Angle::radians(heading).expect("a heading");
        let (sin, cos) = self.pose.heading.get().sin_cos();
        self.pose.position += Vector2::new(cos, sin) * (self.advice.speed * 0.1);
        self.advice
    }

    /// Ticks until the state has this name, for so many seconds at most.
    fn until(&mut self, name: &str, seconds: u64) {
        for _ in 0..10 * seconds {
            if self.law.state().name() == name {
                return;
            }
            self.tick();
            self.nobody_is_touched();
        }
        panic!(
            "{name} is not reached in {seconds} s, but {}: {:?}",
            self.law.state().name(),
            self.events
        );
    }

    fn nobody_is_touched(&self) {
        for (id, at, _) in &self.people {
            let gap = math::norm(at - self.pose.position) - 0.25 - pioneer().robot_radius;
            assert!(gap > 0.0, "person {id} is touched");
        }
    }

    fn shows(&mut self, id: u64, gesture: Option<Gesture>) {
        for (number, _, shown) in &mut self.people {
            if *number == id {
                *shown = gesture;
            }
        }
    }

    fn said(&self, announcement: Announcement) -> usize {
        let said = |event: &&Event| **event == Event::Say(announcement);
        self.events.iter().filter(said).count()
    }
}

/// Turned about the start by an angle: people, goal and robot.
fn turned(people: &[[f32; 2]], angle: f32) -> Stage {
    let (sin, cos) = angle.sin_cos();
    let turn = |[x, y]: [f32; 2]| [cos * x - sin * y, sin * x + cos * y];
    let people: Vec<_> = people.iter().map(|at| turn(*at)).collect();
    let mut stage = Stage::new(&people);
    stage.pose.heading = Angle::radians(angle).expect("a heading");
    stage.goal = turn([7.0, 0.0]).into();
    stage
}

/// Whichever way it faces, it announces itself, stops at the same distance, passes and arrives.
#[test]
fn directions_do_not_matter() {
    for angle in [0.0, 0.8, 1.9, -0.9, -2.4] {
        let mut stage = turned(&[[4.0, 0.3], [4.2, -1.9]], angle);
        stage.until("stop", 40);
        let short = math::norm(stage.people[0].1 - stage.pose.position);
        assert!((2.2..=2.31).contains(&short), "{angle}: {short}");
        stage.until("traverse", 60);
        let path = *stage.law.state().path().expect("a plan");
        let off = path
            .heading()
            .minus(Angle::radians(angle).expect("an angle"))
            .get();
        assert!(off < -0.1, "{angle}: past the one on the left, {off}");
        stage.until("resume", 60);
        // Past both of them along the path, and no farther than it is long.
        let way = math::norm(stage.pose.position - path.from());
        assert!(
            (way - path.length()).abs() < 0.1,
            "{way} of {}",
            path.length()
        );
        stage.until("arrived", 60);
    }
}

/// What a path was made of is what it has.
#[test]
fn paths_have_their_numbers() {
    let heading = Angle::radians(0.5).expect("an angle");
    let path = Path::new(Vector2::new(1.0, 2.0), heading, 3.0, 0.25, 0.75).expect("a path");
    assert_eq!(
        (path.from(), path.heading()),
        (Vector2::new(1.0, 2.0), heading)
    );
    assert_eq!(
        (path.length(), path.speed(), path.turn_rate()),
        (3.0, 0.25, 0.75)
    );
}

/// M2 from each state, where nothing demands a stop and where something does.
#[test]
fn states_follow_each_other() {
    let calm = Situation {
        at_goal: false,
        camera: true,
        stop_shown: false,
        in_path: false,
        near: false,
        path_free: false,
        at_rest: true,
        master: false,
        order: None,
        overdue: false,
        plan: None,
        aligned: true,
        passed: false,
        intruded: false,
    };
    let next = |state: State, now: Situation| interact::next_state(&state, &now);
    let free = Situation {
        path_free: true,
        ..calm
    };
    let led = Situation {
        master: true,
        ..calm
    };
    let stopped = Situation {
        stop_shown: true,
        ..calm
    };
    let blind = Situation {
        camera: false,
        ..calm
    };
    let near = Situation {
        near: true,
        in_path: true,
        ..calm
    };
    let there = Situation {
        in_path: true,
        ..calm
    };
    let overdue = Situation {
        overdue: true,
        ..calm
    };
    let turned_away = Situation {
        aligned: false,
        ..calm
    };
    for (state, now, expected) in [
        (State::Follow, calm, State::Follow),
        (State::Follow, there, State::Announce),
        (State::Announce, near, State::Stop),
        (State::Announce, calm, State::Follow),
        (State::Resume, turned_away, State::Resume),
        (State::Resume, calm, State::Follow),
        (
            State::Stop,
            Situation {
                at_rest: false,
                ..free
            },
            State::Stop,
        ),
        (State::Stop, free, State::Resume),
        (State::Stop, calm, State::AskInteract),
        (State::AskInteract, calm, State::Wait),
        (State::Wait, led, State::Master),
        (State::Wait, free, State::Resume),
        (State::Wait, overdue, State::Plan(Choice::Waypoint)),
        (State::Wait, calm, State::Wait),
        (State::NoFreePath, free, State::Resume),
        (State::NoFreePath, overdue, State::AskInteract),
        (State::NoFreePath, calm, State::NoFreePath),
        (State::Master, led, State::Master),
        (State::Master, calm, State::Wait),
        (
            State::Master,
            Situation {
                overdue: true,
                ..led
            },
            State::Wait,
        ),
        (
            State::Master,
            Situation {
                stop_shown: true,
                ..led
            },
            State::Master,
        ),
        (State::Master, stopped, State::Stop),
        (
            State::Master,
            Situation {
                master: true,
                ..blind
            },
            State::Stop,
        ),
        (State::Follow, stopped, State::Stop),
        (State::Resume, blind, State::Stop),
        (State::Arrived, stopped, State::Arrived),
        (
            State::Wait,
            Situation {
                at_goal: true,
                ..stopped
            },
            State::Arrived,
        ),
    ] {
        assert_eq!(next(state, now), expected, "{state:?}, {now:?}");
    }
}

/// Who is hidden by somebody nearer is held on to; who is not, and is not seen, is let go.
//= interact.INV-7
#[test]
fn who_is_hidden_is_held() {
    let held = |other: [f32; 2], lost: [f32; 2]| {
        let mut stage = Stage::new(&[other, lost]);
        // It waits for somebody who stands in the way.
        stage.until("wait", 60);
        assert_eq!(stage.law.people().count(), 2);
        stage.people.pop();
        for _ in 0..20 {
            stage.tick();
        }
        stage.law.people().count() == 2
    };
    assert!(held([2.5, 0.1], [3.6, 0.3]), "behind them");
    assert!(!held([2.5, 0.1], [3.6, -1.3]), "beside them");
    assert!(!held([3.6, 0.1], [2.5, 0.3]), "before them");
}

/// Nobody in the way: straight to the goal, without a word.
#[test]
fn nobody_there() {
    let mut stage = Stage::new(&[[4.0, 1.8]]);
    stage.until("arrived", 60);
    let entered = |event: &Event| matches!(event, Event::Entered(_));
    assert!(stage.events.iter().all(entered), "{:?}", stage.events);
    assert_eq!(stage.tick(), Advice::REST);
}

/// S3 Fig. 9: it announces itself, stops short, asks, waits, chooses for itself, passes, arrives.
#[test]
fn it_passes_by_itself() {
    let mut stage = Stage::new(&[[4.0, 0.1]]);
    stage.until("announce", 10);
    assert_eq!(stage.said(Announcement::RobotInPath), 1);
    stage.until("stop", 30);
    let short = math::norm(stage.people[0].1 - stage.pose.position);
    assert!((2.2..=2.31).contains(&short), "{short}");
    assert!(stage.said(Announcement::RobotInPath) > 1);
    stage.until("wait", 5);
    assert_eq!(stage.said(Announcement::Interact), 1);
    let since = stage.now;
    stage.until("rotate", 10);
    assert!((6_000..6_400).contains(&(stage.now - since)));
    let path = *stage.law.state().path().expect("a plan");
    stage.until("traverse", 20);
    // The choice is latched.
    assert_eq!(stage.law.state().path(), Some(&path));
    stage.until("resume", 60);
    stage.until("arrived", 60);
    assert_eq!(stage.said(Announcement::NoFreePath), 0);
}

/// Somebody makes way: it goes on, once their place has been seen to be free for long enough.
#[test]
fn somebody_makes_way() {
    let mut stage = Stage::new(&[[3.0, 0.0]]);
    stage.until("wait", 30);
    stage.people[0].1 = Vector2::new(3.0, 2.5);
    let since = stage.now;
    stage.until("resume", 5);
    // They are seen elsewhere at once; out of view it takes the time to be sure.
    assert!(stage.now - since <= 1_500);
    stage.until("arrived", 60);
}

/// ER-X1: one picture without somebody proves nothing; a second of looking at their place does.
//= interact.INV-7
#[test]
fn unseen_is_not_gone() {
    let mut stage = Stage::new(&[[3.0, 0.0]]);
    stage.until("wait", 30);
    let (gone, hold) = (1_000, 10_000);
    let seen = stage.now;
    stage.people.clear();
    for _ in 0..30 {
        let before = stage.law.people().count();
        stage.tick();
        let missed = stage.now - (seen + 100);
        if stage.law.people().count() < before {
            assert!(law::let_go_with_reason(
                missed,
                stage.now - seen,
                gone,
                hold
            ));
            assert!(missed < 1_200, "{missed}");
            return;
        }
        assert_eq!(stage.advice, Advice::REST);
    }
    panic!("still believed to be there");
}

/// Somebody whose place the camera does not show is held on to, for `person_hold_time`.
//= interact.INV-7
#[test]
fn out_of_view_is_held() {
    let mut stage = Stage::new(&[[3.0, 1.9]]);
    for _ in 0..5 {
        stage.tick();
    }
    assert_eq!(stage.law.people().count(), 1);
    let seen = stage.now;
    // Nothing is driven: the robot is turned away by hand.
    stage.pose.heading = Angle::radians(-1.0).expect("a heading");
    stage.goal = stage.pose.position + Vector2::new(0.3, -0.46);
    for _ in 0..200 {
        let before = stage.law.people().count();
        stage.tick();
        stage.pose.position = Vector2::new(0.0, 0.0);
        stage.pose.heading = Angle::radians(-1.0).expect("a heading");
        if stage.law.people().count() < before {
            let unseen = stage.now - seen;
            assert!(
                law::let_go_with_reason(0, unseen, 1_000, 10_000),
                "{unseen}"
            );
            return;
        }
    }
    panic!("held for ever");
}

/// S3 Fig. 8: a master leads it forward, no longer than the gesture lasts and no nearer than the
/// limit, then sends it to one side.
//= interact.INV-3
#[test]
fn a_master_leads() {
    let mut stage = Stage::new(&[[3.6, 0.0]]);
    stage.until("wait", 40);
    stage.shows(1, Some(Gesture::MasterSelect));
    stage.until("master", 2);
    assert_eq!(stage.law.master(), Some(1));
    // Room to be led into: the master steps back.
    stage.people[0].1.x += 1.0;
    stage.shows(1, Some(Gesture::Forward));
    let before = stage.pose.position.x;
    for _ in 0..20 {
        stage.tick();
    }
    assert!(stage.advice.speed > 0.1 && stage.pose.position.x > before + 0.2);
    // The gesture is lowered: rest, in the same cycle.
    stage.shows(1, Some(Gesture::Rest));
    assert_eq!(stage.tick(), Advice::REST);
    // As near as it may come.
    stage.shows(1, Some(Gesture::Forward));
    for _ in 0..200 {
        stage.tick();
    }
    let near = math::norm(stage.people[0].1 - stage.pose.position);
    assert!((1.95..=2.01).contains(&near), "{near}");
    assert_eq!(stage.advice, Advice::REST);
    // Back off, and the master is lost: rest, in the same cycle.
    stage.shows(1, Some(Gesture::Backward));
    for _ in 0..60 {
        stage.tick();
    }
    assert!(stage.advice.speed < 0.0);
    let master = stage.people.pop().expect("the master");
    assert_eq!(stage.tick(), Advice::REST);
    stage.people.push(master);
    // To the person's left, which is the robot's right.
    stage.shows(1, Some(Gesture::Left));
    stage.until("rotate", 3);
    let path = *stage.law.state().path().expect("a plan");
    assert!(path.heading().get() < -0.1, "{path:?}");
    stage.shows(1, None);
    stage.until("resume", 90);
    stage.until("arrived", 60);
}

/// Without sensors that look back it is not led backward.
//= interact.INV-3
#[test]
fn blind_behind_is_not_led_backward() {
    let mut stage = Stage::new(&[[3.0, 0.0]]);
    stage.law = Interact::new(settings(), pioneer(), commissioned(), false);
    stage.until("wait", 30);
    stage.shows(1, Some(Gesture::MasterSelect));
    stage.until("master", 2);
    stage.shows(1, Some(Gesture::Backward));
    for _ in 0..10 {
        assert_eq!(stage.tick(), Advice::REST);
    }
}

/// Others order nothing while there is a master, but anybody may show Stop.
//= interact.INV-1
#[test]
fn stop_from_anyone() {
    let mut stage = Stage::new(&[[3.6, 0.2], [6.0, -2.0]]);
    stage.until("wait", 40);
    stage.shows(1, Some(Gesture::MasterSelect));
    stage.until("master", 2);
    stage.shows(1, None);
    stage.shows(2, Some(Gesture::Right));
    for _ in 0..10 {
        assert_eq!(stage.tick(), Advice::REST);
        assert_eq!(stage.law.state().name(), "master");
    }
    stage.shows(2, None);
    stage.shows(1, Some(Gesture::Left));
    stage.until("traverse", 20);
    for _ in 0..60 {
        stage.tick();
    }
    assert!(stage.advice.speed > 0.05);
    // Not the master, and it stops all the same.
    stage.shows(2, Some(Gesture::Stop));
    assert_eq!(stage.tick(), Advice::REST);
    for _ in 0..50 {
        assert_eq!(stage.tick(), Advice::REST);
        assert_eq!(stage.law.state().name(), "stop");
    }
    stage.shows(2, None);
    stage.shows(1, None);
    stage.until("wait", 5);
}

/// A camera that gives nothing more stops the robot, wherever it is.
//= interact.INV-1
#[test]
fn no_camera_no_motion() {
    let mut stage = Stage::new(&[[4.0, 0.1]]);
    stage.until("traverse", 60);
    stage.camera = false;
    let mut moved = 0;
    for _ in 0..50 {
        moved += u32::from(stage.tick() != Advice::REST);
    }
    // The last picture is good for 0.3 s.
    assert!((2..=3).contains(&moved), "{moved}");
    assert_eq!(stage.law.state().name(), "stop");
    let mut never = Stage::new(&[]);
    never.camera = false;
    for _ in 0..20 {
        assert_eq!(never.tick(), Advice::REST);
    }
}

/// Somebody steps into what is left of the way: it stops, and plans anew.
#[test]
fn somebody_steps_in() {
    let mut stage = Stage::new(&[[4.0, 0.3], [4.2, -1.9]]);
    stage.until("traverse", 60);
    let path = *stage.law.state().path().expect("a plan");
    for _ in 0..20 {
        stage.tick();
    }
    let (sin, cos) = path.heading().get().sin_cos();
    stage.people[1].1 = path.from() + Vector2::new(cos, sin) * 2.4;
    stage.tick();
    assert_eq!(stage.law.state().name(), "stop");
    assert_eq!(stage.advice, Advice::REST);
    stage.until("wait", 5);
}

/// There is no valley: it says so, waits, asks again, and says so again; not at every tick.
#[test]
fn no_free_path_is_said() {
    let mut stage = Stage::new(&[[3.0, -0.9], [3.0, 0.0], [3.0, 0.9]]);
    stage.until("no-free-path", 60);
    assert_eq!(stage.said(Announcement::NoFreePath), 1);
    for _ in 0..250 {
        assert_eq!(stage.tick(), Advice::REST);
    }
    assert!((2..=3).contains(&stage.said(Announcement::NoFreePath)));
    // An order that cannot be followed is answered once while it lasts.
    stage.shows(2, Some(Gesture::MasterSelect));
    stage.until("master", 20);
    stage.shows(2, Some(Gesture::Left));
    let said = stage.said(Announcement::NoFreePath);
    for _ in 0..30 {
        assert_eq!(stage.tick(), Advice::REST);
    }
    assert_eq!(stage.said(Announcement::NoFreePath), said + 1);
}

/// Six people may be more: slower.
#[test]
fn a_crowd_is_passed_more_slowly() {
    let speed = |people: &[[f32; 2]]| {
        let mut stage = Stage::new(people);
        stage.until("traverse", 60);
        stage.law.state().path().expect("a plan").speed()
    };
    // One in the way, the rest along one side.
    let crowd = [
        [4.0, 0.1],
        [4.5, 1.0],
        [4.6, 0.5],
        [4.9, 1.1],
        [5.2, 0.7],
        [5.5, 1.2],
    ];
    let (few, many) = (speed(&crowd[..2]), speed(&crowd));
    assert!(many <= 0.5 * few + 1e-3, "{few} {many}");
}

/// A master who orders nothing, or is out of sight, is no master any more.
//= interact.INV-4
#[test]
fn a_master_is_let_go() {
    let mut stage = Stage::new(&[[3.0, 0.0]]);
    stage.until("wait", 30);
    stage.shows(1, Some(Gesture::MasterSelect));
    stage.until("master", 2);
    stage.shows(1, None);
    let since = stage.now;
    stage.until("wait", 30);
    assert!((19_000..21_000).contains(&(stage.now - since)));
    assert_eq!(stage.law.master(), None);
    assert!(stage.events.contains(&Event::MasterLost));
}

/// A picture of skeletons: whoever has a neck has a place, and shoulders measure them.
#[test]
fn skeletons_have_places() {
    let at = |x, y, z| Some(gesture::Point::new(x, y, z));
    let skeleton = Skeleton {
        id: 7,
        neck: at(0.4, 1.4, 3.0),
        left_shoulder: at(0.2, 1.35, 3.0),
        right_shoulder: at(0.62, 1.4, 3.0),
        ..Skeleton::default()
    };
    let nobody = Skeleton {
        id: 8,
        ..Skeleton::default()
    };
    let mut frame = gesture::Frame {
        taken_at: Instant(5),
        people: [None; PEOPLE_MAX],
    };
    frame.people[2] = Some(skeleton);
    frame.people[3] = Some(nobody);
    let mut gestures = [None; PEOPLE_MAX];
    gestures[2] = Some(Gesture::Stop);
    let people = People::of(&frame, &gestures);
    assert_eq!(people.taken_at, Instant(5));
    let someone = people.people[2].expect("there");
    assert_eq!((someone.id, someone.lateral, someone.depth), (7, 0.4, 3.0));
    assert!((someone.radius.expect("measured") - 0.22).abs() < 1e-3);
    assert_eq!(someone.gesture, Some(Gesture::Stop));
    assert_eq!(people.people.iter().flatten().count(), 1);
}

/// A configuration that leaves no valley where the robot stops is refused, with the distance.
#[test]
fn settings_leave_room() {
    let wide = Parameters {
        safety_distance: 0.9,
        ..USUAL
    };
    let error = Settings::new(wide, &pioneer()).expect_err("no room");
    assert_eq!(error.field, "stop_distance");
    assert!(error.min > 2.3, "{error}");
}

/// What is said to people is what S3 says.
#[test]
fn announcements_are_those_of_s3() {
    assert_eq!(Announcement::RobotInPath.text(), "Robot in the path");
    assert_eq!(Announcement::Interact.text(), "Interact");
    assert_eq!(Announcement::NoFreePath.text(), "No free path");
}
