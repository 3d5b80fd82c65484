//! Worked cases, per equation: `lit` is the formula as printed, `rec` the reading chosen.
//!
//! The f64 reference of `sidestep-spec` must meet each case's tolerance. Where the core computes
//! the same thing, the f32 core must too, at max(tol, 2e-5·|expected|); angles are compared on
//! the circle, at 2e-5 of the largest angle of the case. `SIDESTEP_GOLDEN` names another file.

use serde_json::Value;
use sidestep::avoid::{self, Mode, QuarterTurns, Side, Situation, Trend};
use sidestep::config::Config;
use sidestep::decide;
use sidestep::edge::{self, ActualEdge, EdgeConfig, Gap, PAPER, PlannedEdge};
use sidestep::kinematics::{DifferentialDrive, WheelRates, velocity};
use sidestep::observation::Sighting;
use sidestep::preset;
use sidestep::quantity::{Angle, Instant, Length, Speed};
use sidestep::valley::{Geometry, Heading, Person, Scene};
use sidestep::view::Pose;
use sidestep_spec as spec;
use std::collections::BTreeMap;

/// Named results; numbers, words and truths alike.
type Outputs = Vec<(&'static str, Value)>;

/// What a case must come to: by the reference, and by the core where it computes this.
struct Computed {
    reference: Outputs,
    core: Option<Outputs>,
}

struct Input<'a>(&'a Value);

impl Input<'_> {
    fn number(&self, name: &str) -> f64 {
        match &self.0[name] {
            Value::Null if self.0.get(name).is_some() => f64::NAN,
            Value::String(word) => word
                .parse()
                .unwrap_or_else(|_| panic!("no number {name} in {}", self.0)),
            value => value
                .as_f64()
                .unwrap_or_else(|| panic!("no number {name} in {}", self.0)),
        }
    }

    fn numbers(&self, name: &str) -> Vec<f64> {
        let values = self.0[name].as_array();
        let values = values.unwrap_or_else(|| panic!("no numbers {name} in {}", self.0));
        // A null stands for NaN.
        let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
        values.iter().map(number).collect()
    }

    fn rows(&self, name: &str) -> Vec<Vec<f64>> {
        let rows = self.0[name].as_array();
        let rows = rows.unwrap_or_else(|| panic!("no rows {name} in {}", self.0));
        let row = |row: &Value| {
            let values = row.as_array().expect("a row");
            values
                .iter()
                .map(|value| value.as_f64().expect("a number"))
                .collect()
        };
        rows.iter().map(row).collect()
    }

    fn truth(&self, name: &str) -> bool {
        self.0[name]
            .as_bool()
            .unwrap_or_else(|| panic!("no truth {name} in {}", self.0))
    }

    fn word(&self, name: &str) -> &str {
        self.0[name]
            .as_str()
            .unwrap_or_else(|| panic!("no word {name} in {}", self.0))
    }

    /// A length or speed given in centimetres, in metres.
    fn metres(&self, name: &str) -> f32 {
        (self.number(name) / 100.0) as f32
    }

    fn length(&self, name: &str) -> Length {
        Length::metres(self.metres(name)).expect("a length")
    }

    fn speed(&self, name: &str) -> Speed {
        Speed::metres_per_second(self.metres(name)).expect("a speed")
    }

    fn radians(&self, name: &str) -> f32 {
        self.number(name).to_radians() as f32
    }

    fn angle(&self, radians: f32) -> Angle {
        Angle::radians(radians).expect("an angle")
    }
}

fn number(value: f64) -> Value {
    // JSON has no infinity; a NaN becomes null, which is how a case says "undefined".
    if value == f64::INFINITY {
        Value::from("inf")
    } else {
        Value::from(value)
    }
}

fn centimetres(speed: Speed) -> Value {
    number(f64::from(speed.get()) * 100.0)
}

fn radians(angle: f32) -> Value {
    number(f64::from(angle))
}

fn sighting(i: &Input) -> Sighting {
    Sighting {
        displacement: i.number("dp_px") as f32,
        scale: i.metres("s_cm_per_px"),
        interval: i.number("t_s") as f32,
        direction: i.radians("theta_o_deg"),
        taken_at: Instant(0),
    }
}

/// The sensor of S3, with the robot's radius and the safety distance (m).
fn kinect(robot_radius: f32, safety_distance: f32) -> Geometry {
    Geometry::new(robot_radius, safety_distance, 35_f32.to_radians()).expect("a geometry")
}

fn s3_geometry(i: &Input) -> spec::valley::Geometry {
    spec::valley::Geometry {
        robot_radius: i.number("r_r"),
        safety_distance: i.number("d"),
        view_half_angle_deg: 35.0,
    }
}

/// S3.E1 to E24: every region of a scene. Which is accepted is judged for the direction that the
/// equations give; the core may find another in the same region (spec/valley.md, S3.E19).
fn valley_regions(printed: bool, i: &Input) -> Computed {
    let geometry = s3_geometry(i);
    let people: Vec<spec::valley::Person> = i.0["persons_X_Zrange_rp"]
        .as_array()
        .expect("people")
        .iter()
        .map(|person| {
            let number = |at: usize| person[at].as_f64().expect("a number");
            spec::valley::Person {
                lateral: number(0),
                range: number(1),
                radius: number(2),
            }
        })
        .collect();
    let core_people: Vec<Person> = people
        .iter()
        .map(|p| Person::new(p.lateral as f32, p.range as f32, p.radius as f32).expect("a person"))
        .collect();
    let core_geometry = kinect(
        geometry.robot_radius as f32,
        geometry.safety_distance as f32,
    );
    let scene = Scene::new(&core_people).expect("at most six");
    let (mut reference, mut core) = (Vec::new(), Vec::new());
    for region in spec::valley::regions(&people, &geometry, printed) {
        let gap = region.gap(&people);
        let kind = match region.index {
            0 => "left".to_owned(),
            index if index == people.len() => "right".to_owned(),
            index => format!("mid{index}"),
        };
        let mut fields = serde_json::json!({
            "kind": kind,
            "R_av": region.available,
            "R_min": region.least,
            "ok": region.wide_enough(),
            "x_ca": region.lateral,
            "Z_ca": region.range,
            "theta_ca_deg": region.heading_deg,
            "d_ca": region.length,
            "theta_r_deg": region.width_deg,
            "centreline_gap_m": gap,
        });
        let found = core_geometry
            .region(&scene, region.index)
            .expect("a region");
        let mut found_fields = serde_json::json!({
            "R_av": found.available,
            "x_ca": found.lateral,
            "Z_ca": found.range,
            "theta_r_deg": f64::from(found.width).to_degrees(),
        });
        if !printed {
            // To the last bit the path beside a person is exactly as far away as it must be.
            let needed = geometry.robot_radius + geometry.safety_distance / 2.0;
            let clear = gap >= needed - 1e-12;
            let in_view = region.heading_deg.abs() <= geometry.view_half_angle_deg;
            let accepted = region.wide_enough() && clear && in_view;
            fields["path_clear"] = clear.into();
            fields["heading_in_fov"] = in_view.into();
            fields["accepted"] = accepted.into();
            found_fields["R_min"] = found.least.into();
            // A width that is exactly what is needed, to the last bit, is decided by rounding.
            if (region.available - region.least).abs() > 1e-6 {
                found_fields["ok"] = found.is_wide_enough().into();
            }
            let valley = core_geometry.valley(&scene, region.index);
            if accepted || !region.wide_enough() {
                found_fields["accepted"] = valley.is_some().into();
            }
            if let Some(valley) = valley.filter(|_| accepted) {
                let heading = f64::from(valley.heading.angle()).to_degrees();
                found_fields["theta_ca_deg"] = heading.into();
                found_fields["d_ca"] = valley.length.into();
            }
        }
        reference.push(fields);
        core.push(found_fields);
    }
    Computed {
        reference: vec![("regions", Value::from(reference))],
        core: Some(vec![("regions", Value::from(core))]),
    }
}

/// What the reference and the core make of a case; `None` if its equation is not here yet.
fn compute(equation: &str, variant: &str, i: &Input) -> Option<Computed> {
    let computed = match (equation, variant) {
        ("S3.T1", "printed") => {
            let (average, success) = spec::gesture::t1(
                i.number("total_error"),
                i.number("folds"),
                i.number("samples"),
            );
            Computed {
                reference: vec![
                    ("average_error", number(average)),
                    ("success_pct", number(success)),
                ],
                core: None,
            }
        }
        ("S1.E1", "lit") => {
            let (heading, camera) = (i.number("theta_R_deg"), i.number("theta_cam_deg"));
            let core = avoid::obstacle_robot_angle(
                i.angle(heading.to_radians() as f32),
                i.angle(camera.to_radians() as f32),
            );
            Computed {
                reference: vec![(
                    "theta_OR_deg",
                    number(spec::avoid::e1_printed(heading, camera)),
                )],
                core: Some(vec![(
                    "theta_OR_deg",
                    number(f64::from(core.get()).to_degrees()),
                )]),
            }
        }
        //= avoid.INV-2
        ("S1.E2", "lit") => Computed {
            reference: vec![(
                "v_o_cos_theta_o_cm_s",
                number(spec::avoid::e2_printed(
                    i.number("dp_px"),
                    i.number("s_cm_per_px"),
                    i.number("t_s"),
                    i.number("v_R_cm_s"),
                    i.number("theta_R_deg"),
                )),
            )],
            core: None,
        },
        //= avoid.INV-1
        //= avoid.INV-3
        ("S1.E3", variant) => {
            let terms = [
                "dp_px",
                "s_cm_per_px",
                "t_s",
                "theta_o_deg",
                "v_R_cm_s",
                "theta_R_deg",
                "v_o_max_cm_s",
            ]
            .map(|name| i.number(name));
            let [dp, s, t, direction, v, heading, max] = terms;
            let core = avoid::obstacle_speed(
                &sighting(i),
                i.speed("v_R_cm_s"),
                i.angle(i.radians("theta_R_deg")),
                i.speed("v_o_max_cm_s"),
            );
            let reference = if variant == "lit" {
                spec::avoid::e3_printed(dp, s, t, direction, v, heading, max)
            } else {
                spec::avoid::e3(dp, s, t, direction, v, heading, max).0
            };
            // Where E3 as printed and as read agree, the core is judged by the printed cases too.
            let same = reference == spec::avoid::e3(dp, s, t, direction, v, heading, max).0;
            Computed {
                reference: vec![("v_o_cm_s", number(reference))],
                core: same.then(|| vec![("v_o_cm_s", centimetres(core.value))]),
            }
        }
        ("S1.E4", "lit") => {
            let terms = [
                "d_o_cm",
                "theta_R_deg",
                "theta_cam_deg",
                "v_R_cm_s",
                "v_o_cm_s",
                "theta_o_deg",
                "T_s",
            ]
            .map(|name| i.number(name));
            let [d, heading, camera, v, vo, direction, stop_time] = terms;
            let (t, stop) =
                spec::avoid::e4_printed(d, heading, camera, v, vo, direction, stop_time);
            Computed {
                reference: vec![("t_s", number(t)), ("stop", Value::from(stop))],
                core: None,
            }
        }
        //= avoid.INV-4
        ("S1.E4", "rec") => {
            let (t, stop) = spec::avoid::e4_bound(
                i.number("d_o_cm"),
                i.number("R_contact_cm"),
                i.number("v_R_cm_s"),
                i.number("v_o_cm_s"),
                i.number("T_s"),
            );
            let core = avoid::contact_time_bound(
                i.length("d_o_cm"),
                i.length("R_contact_cm"),
                i.speed("v_R_cm_s"),
                i.speed("v_o_cm_s"),
            );
            let core_stop = core.is_some_and(|t| f64::from(t) <= i.number("T_s"));
            Computed {
                reference: vec![("t_lb_s", number(t)), ("stop", Value::from(stop))],
                core: Some(vec![
                    ("t_lb_s", number(core.map_or(f64::INFINITY, f64::from))),
                    ("stop", Value::from(core_stop)),
                ]),
            }
        }
        ("S1.E5", "lit") => {
            let (turn, heading) = spec::avoid::e5_printed(
                i.number("d_o_cm"),
                i.number("k_theta_cm"),
                i.number("theta_R_rad"),
                i.word("side") == "right_of_obs",
            );
            Computed {
                reference: vec![
                    ("dtheta_rad", number(turn)),
                    ("theta_m_rad", number(heading)),
                ],
                core: None,
            }
        }
        //= avoid.INV-6
        //= avoid.INV-7
        //= avoid.INV-8
        ("S1.E5", "rec") => {
            let bearing = i.number("obstacle_bearing_deg");
            let reference_heading = i.number("theta_ref_rad");
            let (turn, sign, heading) = spec::avoid::e5(
                i.number("d_o_cm"),
                i.number("k_theta_cm"),
                reference_heading,
                bearing,
            );
            let core_turn = QuarterTurns::at_distance(i.length("d_o_cm"), i.length("k_theta_cm"));
            let side = Side::away_from(
                i.angle(bearing.to_radians() as f32),
                Length::ZERO,
                Length::ZERO,
            );
            let core_heading =
                avoid::maneuver_heading(i.angle(reference_heading as f32), side, core_turn);
            Computed {
                reference: vec![
                    ("dtheta_rad", number(turn)),
                    ("turn_sign", number(sign)),
                    ("theta_m_rad", number(heading)),
                ],
                core: Some(vec![
                    ("dtheta_rad", radians(core_turn.angle().get())),
                    (
                        "turn_sign",
                        number(if side == Side::Left { 1.0 } else { -1.0 }),
                    ),
                    ("theta_m_rad", radians(core_heading.get())),
                ]),
            }
        }
        ("S1.E6", "lit") => {
            let reference = i.number("theta_ref_rad");
            let core = avoid::maneuver_heading(
                i.angle(reference as f32),
                Side::Left,
                QuarterTurns::of_angle(0.0).expect("no turn"),
            );
            Computed {
                reference: vec![("theta_m_rad", number(spec::avoid::e6(reference)))],
                core: Some(vec![("theta_m_rad", radians(core.get()))]),
            }
        }
        //= avoid.INV-9
        ("S1.E7", variant) => {
            let (turn, speed_max) = (i.number("dtheta_rad"), i.number("v_max_cm_s"));
            let reference = if variant == "lit" {
                spec::avoid::e7_printed(turn, speed_max)
            } else {
                spec::avoid::e7(turn, speed_max)
            };
            let core = avoid::maneuver_speed(
                i.speed("v_max_cm_s"),
                QuarterTurns::of_angle(turn as f32).expect("a turn"),
            );
            let same = (reference - spec::avoid::e7(turn, speed_max)).abs() < 1e-12;
            Computed {
                reference: vec![("v_R_cm_s", number(reference))],
                core: same.then(|| vec![("v_R_cm_s", centimetres(core))]),
            }
        }
        ("S1.E5+E7", "lit") => {
            let (d, k, speed_max) = (
                i.number("d_o_cm"),
                i.number("k_theta_cm"),
                i.number("v_max_cm_s"),
            );
            let turn = spec::avoid::e5_printed(d, k, 0.0, true).0;
            let core_turn = QuarterTurns::at_distance(i.length("d_o_cm"), i.length("k_theta_cm"));
            let core_speed = avoid::maneuver_speed(i.speed("v_max_cm_s"), core_turn);
            Computed {
                reference: vec![
                    ("dtheta_rad", number(turn)),
                    ("v_R_cm_s", number(spec::avoid::e7_printed(turn, speed_max))),
                ],
                // Beyond half a turn the printed formula reverses; the reading does not.
                core: (turn <= std::f64::consts::PI).then(|| {
                    vec![
                        ("dtheta_rad", radians(core_turn.angle().get())),
                        ("v_R_cm_s", centimetres(core_speed)),
                    ]
                }),
            }
        }
        //= avoid.INV-12
        ("S1.A1", "rec") => {
            let (goal, customer) = (i.truth("goal_pose_reached"), i.truth("customer_confirmed"));
            let core = avoid::arrival(
                i.length("front_cm"),
                i.length("min_distance_cm"),
                goal,
                customer,
            );
            let reference = spec::avoid::a1(
                i.number("front_cm"),
                i.number("min_distance_cm"),
                goal,
                customer,
            );
            Computed {
                reference: vec![("result", Value::from(reference))],
                core: Some(vec![("result", Value::from(format!("{core:?}")))]),
            }
        }
        //= avoid.INV-14
        ("S1.A3", "rec") => {
            let orientation = i.number("global_orientation_deg");
            let (image, folded, approaching) = spec::avoid::a3(orientation);
            let (core_folded, core_approaching) =
                avoid::image_direction(orientation.to_radians() as f32).expect("an orientation");
            Computed {
                reference: vec![
                    ("theta_o_image_deg", number(image)),
                    ("theta_o_folded_deg", number(folded)),
                    ("approaching", Value::from(approaching)),
                ],
                core: Some(vec![
                    (
                        "theta_o_folded_deg",
                        number(f64::from(core_folded).to_degrees()),
                    ),
                    ("approaching", Value::from(core_approaching)),
                ]),
            }
        }
        //= avoid.INV-10
        //= avoid.INV-11
        ("S1.A4", "rec") => {
            let (distance, time) = (i.number("d_o_cm"), i.number("ttc_s"));
            let fresh = i.truth("sensors_fresh");
            let (mode, trend) = (i.word("mode"), i.word("trend"));
            let config = Config::new(preset::SRIKANDI_II_2012).expect("the preset");
            let situation = Situation {
                distance: Some(i.length("d_o_cm")),
                trend: match trend {
                    "closing" => Trend::Closing,
                    "receding" => Trend::Receding,
                    "steady" => Trend::Steady,
                    _ => Trend::Unknown,
                },
                guard: !fresh
                    || i.metres("d_o_cm") <= config.min_distance
                    || time as f32 <= config.stop_time,
                corridor_free: true,
                aligned: false,
                at_goal: false,
            };
            let from = match mode {
                "Cruise" => Mode::Cruise,
                "Maneuver" => Mode::Maneuver,
                "Reorient" => Mode::Reorient,
                "Stop" => Mode::Stop,
                other => panic!("unknown mode {other}"),
            };
            let core = avoid::next_mode(from, &situation, &config);
            Computed {
                reference: vec![(
                    "next",
                    Value::from(spec::avoid::a4(mode, distance, trend, time, fresh)),
                )],
                core: Some(vec![("next", Value::from(format!("{core:?}")))]),
            }
        }
        ("S2.E1-3", "lit") => {
            let (v, heading, turn_rate) = (
                i.number("v_R_m_s"),
                i.number("theta_R_deg"),
                i.number("omega_R_rad_s"),
            );
            let (x, y, turn) = spec::kinematics::e1_e3(v, heading, turn_rate);
            let core = velocity(v as f32, i.angle(heading.to_radians() as f32));
            Computed {
                reference: vec![
                    ("xdot", number(x)),
                    ("ydot", number(y)),
                    ("thetadot", number(turn)),
                ],
                core: Some(vec![
                    ("xdot", radians(core.x)),
                    ("ydot", radians(core.y)),
                    ("thetadot", number(turn_rate)),
                ]),
            }
        }
        //= kinematics.INV-1
        ("S2.E5", variant) => {
            let (radius, right, left) = (i.number("R_m"), i.number("omega_r"), i.number("omega_l"));
            let base = if variant == "rec" {
                i.number("L_m")
            } else {
                1.0
            };
            let core = DifferentialDrive::new(radius as f32, base as f32)
                .and_then(|drive| {
                    drive.twist(WheelRates {
                        right: right as f32,
                        left: left as f32,
                    })
                })
                .expect("a drive");
            let yaw = spec::kinematics::yaw(radius, base, right, left);
            let mut reference =
                vec![("v_R_m_s", number(spec::kinematics::e5(radius, right, left)))];
            let mut core = vec![
                ("v_R_m_s", radians(core.speed)),
                ("omega_R_rad_s", radians(core.turn_rate)),
            ];
            if variant == "rec" {
                reference.push(("omega_R_rad_s", number(yaw)));
            } else {
                core.pop();
            }
            Computed {
                reference,
                core: Some(core),
            }
        }
        ("S2.E6", "lit") => {
            let (heading, camera) = (i.number("theta_R_deg"), i.number("theta_cam_deg"));
            let core = avoid::obstacle_robot_angle(
                i.angle(heading.to_radians() as f32),
                i.angle(camera.to_radians() as f32),
            );
            let core = number(f64::from(core.get()).to_degrees());
            Computed {
                reference: vec![(
                    "theta_MO_R_deg",
                    number(spec::decide::e6_printed(heading, camera)),
                )],
                core: Some(vec![("theta_MO_R_deg", core)]),
            }
        }
        ("S2.E7", "lit") => {
            let terms = [
                "d_MO_cm",
                "theta_R_deg",
                "theta_cam_deg",
                "v_R_m_s",
                "v_MO_m_s",
                "theta_MO_deg",
            ]
            .map(|name| i.number(name));
            let [d, heading, camera, v, vo, direction] = terms;
            let metres_per_second =
                |speed| Speed::metres_per_second(speed as f32).expect("a speed");
            let angle = |degrees: f64| i.angle(degrees.to_radians() as f32);
            let core = decide::time_to_level(
                i.length("d_MO_cm"),
                angle(heading),
                angle(camera),
                metres_per_second(v),
                metres_per_second(vo),
                angle(direction),
            );
            let (d, printed) = (d / 100.0, spec::decide::e7_printed);
            Computed {
                reference: vec![("t_s", number(printed(d, heading, camera, v, vo, direction)))],
                core: Some(vec![("t_s", number(core.map_or(f64::INFINITY, f64::from)))]),
            }
        }
        ("S2.E8", "lit") => {
            let heading = i.number("theta_R_rad");
            let (distance, reach) = (i.number("d_MO_cm"), i.number("k_theta_cm"));
            let turn = QuarterTurns::at_distance(i.length("d_MO_cm"), i.length("k_theta_cm"));
            let core = avoid::maneuver_heading(i.angle(heading as f32), Side::Left, turn);
            Computed {
                reference: vec![(
                    "theta_m_rad",
                    number(spec::decide::e8_printed(distance, reach, heading)),
                )],
                core: Some(vec![("theta_m_rad", radians(core.get()))]),
            }
        }
        //= avoid.INV-9
        ("S2.E10", "lit") => {
            let speed_max = i.number("V_max_m_s");
            let (distance, reach) = (i.number("d_MO_cm"), i.number("k_theta_cm"));
            let turn = QuarterTurns::at_distance(i.length("d_MO_cm"), i.length("k_theta_cm"));
            let speed_max_core = Speed::metres_per_second(speed_max as f32).expect("a speed");
            let core = avoid::maneuver_speed(speed_max_core, turn);
            Computed {
                reference: vec![(
                    "V_R_m_s",
                    number(spec::decide::e10_printed(distance, reach, speed_max)),
                )],
                core: Some(vec![("V_R_m_s", radians(core.get()))]),
            }
        }
        //= decide.INV-1
        //= decide.INV-2
        //= decide.INV-3
        ("S2.E21", variant) => {
            let (likelihood, prior) = (i.numbers("likelihood"), i.numbers("prior"));
            let reference = spec::decide::e21(&likelihood, &prior);
            let core = belief(&prior).and_then(|prior| prior.updated(&pair(&likelihood)));
            // Without a posterior any table ends in its safest action; with one, these cases ask none.
            let action = decide::LossTable::TABLE_2.respond(&core);
            let posterior =
                |posterior: Option<Vec<f64>>| posterior.map_or(Value::Null, Value::from);
            let mut both = [
                vec![("posterior", posterior(reference.clone()))],
                vec![("posterior", posterior(core.ok().map(probabilities)))],
            ];
            if variant == "rec" {
                let table = table(&spec::decide::TABLE_2);
                let chosen = spec::decide::choose(&table, reference.as_deref());
                for (outputs, chosen) in both.iter_mut().zip([chosen, action]) {
                    outputs.push(("action", Value::from(spec::decide::ACTIONS[chosen])));
                }
            }
            let [reference, core] = both;
            Computed {
                reference,
                core: Some(core),
            }
        }
        ("S2.E26", "printed") => {
            let (likelihood, prior) = (i.numbers("likelihood"), i.numbers("prior"));
            let printed = Value::from(spec::decide::POSTERIOR_PRINTED.to_vec());
            let reference = spec::decide::e21(&likelihood, &prior).expect("a posterior");
            let core = belief(&prior).and_then(|prior| prior.updated(&pair(&likelihood)));
            let core = Value::from(probabilities(core.expect("a posterior")));
            Computed {
                reference: vec![
                    ("posterior_printed", printed),
                    ("posterior_correct", Value::from(reference)),
                ],
                core: Some(vec![("posterior_correct", core)]),
            }
        }
        //= decide.INV-7
        //= decide.INV-8
        //= decide.INV-9
        //= decide.INV-11
        ("S2.E22", "rec") => {
            let posterior = i.numbers("posterior");
            let rows = i.rows("loss");
            let seconds = [pair(&rows[0]), pair(&rows[1])];
            // Both of the paper's tables have an action that is dominated.
            assert!(decide::LossTable::new(&seconds).is_err());
            let core = decide::LossTable::with_dominated(&seconds).expect("losses");
            let core_belief = belief(&posterior).expect("a posterior");
            let expected = core.expected_seconds(&core_belief).map(f64::from).to_vec();
            let action = |chosen: usize| Value::from(spec::decide::ACTIONS[chosen]);
            Computed {
                reference: vec![
                    ("B", Value::from(spec::decide::e22(&rows, &posterior))),
                    (
                        "action",
                        action(spec::decide::choose(&rows, Some(&posterior))),
                    ),
                ],
                core: Some(vec![
                    ("B", Value::from(expected)),
                    ("action", action(core.choose(&core_belief))),
                ]),
            }
        }
        ("S2.E29", "printed") => Computed {
            reference: vec![(
                "B",
                Value::from(spec::decide::e22(&i.rows("loss"), &i.numbers("posterior"))),
            )],
            // What does not add up to 1 is no belief.
            core: None,
        },
        //= decide.INV-4
        //= decide.INV-5
        ("S2.E13", "lit") => {
            let first = i.number("prior_obstacle");
            let (likelihood, prior) = (i.numbers("likelihood"), [first, 1.0 - first]);
            let updates = i.number("updates") as usize;
            let reference = spec::decide::e13(&likelihood, &prior, updates).expect("a belief");
            let mut core = belief(&prior).expect("a belief");
            for _ in 0..updates {
                core = core.updated(&pair(&likelihood)).expect("a posterior");
            }
            Computed {
                reference: vec![("p_obstacle", number(reference[0]))],
                core: Some(vec![("p_obstacle", radians(core.probability(0)))]),
            }
        }
        //= decide.INV-6
        ("S2.E16", "lit") => {
            let (before, rows) = (i.numbers("belief"), i.rows("P[from][to]"));
            let transition = decide::TransitionMatrix::new(&[pair(&rows[0]), pair(&rows[1])]);
            let core = belief(&before).expect("a belief");
            let core = core.predicted(&transition.expect("stochastic"));
            let reference = spec::decide::e16(&before, &rows);
            Computed {
                reference: vec![("predicted", Value::from(reference))],
                core: Some(vec![("predicted", Value::from(probabilities(core)))]),
            }
        }
        (equation, variant) if equation.starts_with("S4.") => return edge(equation, variant, i),
        //= valley.INV-1
        //= valley.INV-2
        //= valley.INV-6
        ("S3.E1-24", variant) => valley_regions(variant == "lit", i),
        ("S3.E3-5", "lit") => {
            let (lateral, range) = (i.number("X"), i.number("Z_range"));
            let person = Person::new(lateral as f32, range as f32, 0.2).expect("a person");
            let bearing = f64::from(person.bearing()).to_degrees();
            Computed {
                reference: vec![
                    ("delta_deg", number(spec::valley::e3(lateral, range))),
                    ("Z_temp", number(spec::valley::e4(lateral, range))),
                    ("X_term", number(spec::valley::e5(lateral, range, 35.0))),
                ],
                core: Some(vec![
                    ("delta_deg", number(bearing)),
                    ("Z_temp", radians(person.depth())),
                    ("X_term", radians(kinect(0.25, 0.3).edge(&person))),
                ]),
            }
        }
        ("S3.E10", "rec") => {
            let (left, right) = (i.number("x_i"), i.number("x_i1"));
            let people = [left, right].map(|x| Person::new(x as f32, 5.0, 0.2).expect("a person"));
            let scene = Scene::new(&people).expect("two people");
            let region = kinect(0.25, 0.3).region(&scene, 1).expect("between them");
            let half = spec::valley::e10_printed(left, right);
            Computed {
                reference: vec![
                    ("x_ca", number(spec::valley::e10(left, right))),
                    ("paper_literal_half_width", number(half)),
                ],
                core: Some(vec![("x_ca", radians(region.lateral))]),
            }
        }
        ("S3.E14-16", "rec") => {
            let (lateral, depth) = (i.number("x_ca"), i.number("Z_temp"));
            let range = spec::valley::e15(lateral, depth);
            let length = spec::valley::e16_printed(&s3_geometry(i), range, i.number("r_f"));
            // Two people as deep as that, with the middle between them.
            let people = [-0.5, 0.5].map(|off| {
                Person::at(depth as f32, -(lateral as f32 + off), 0.2).expect("a person")
            });
            let scene = Scene::new(&people).expect("two people");
            let region = kinect(0.25, 0.3).region(&scene, 1).expect("between them");
            let heading = f64::from(Heading::new(region.sine).angle()).to_degrees();
            Computed {
                reference: vec![
                    ("theta_ca_deg", number(spec::valley::e14(lateral, depth))),
                    ("Z_ca", number(range)),
                    ("d_ca", number(length)),
                ],
                core: Some(vec![
                    ("theta_ca_deg", number(heading)),
                    ("Z_ca", radians(region.range)),
                ]),
            }
        }
        ("S3.E19-20", "rec") => {
            let (lateral, range) = (i.number("x_ca"), i.number("Z_ca"));
            let geometry = spec::valley::Geometry {
                robot_radius: i.number("r_r"),
                safety_distance: 0.0,
                view_half_angle_deg: 35.0,
            };
            let heading = spec::valley::e19(lateral, range);
            let length = spec::valley::e20_printed(&geometry, lateral, range, i.number("r_p"));
            Computed {
                reference: vec![
                    ("theta_ca_deg", number(heading)),
                    ("d_ca_paper", number(length)),
                    ("valid", Value::from(heading.is_finite())),
                ],
                core: None,
            }
        }
        //= valley.INV-4
        ("S3.E25" | "S3.E26", variant) => {
            let (width, whole) = (i.number("theta_r_deg"), i.number("theta_max_deg"));
            let [greatest, printed, exact, derived] = if equation == "S3.E25" {
                ["v_max", "v_printed", "v_exact", "v"]
            } else {
                [
                    "omega_max",
                    "omega_printed",
                    "omega_exact",
                    "omega_magnitude",
                ]
            };
            let share = if variant == "rec" {
                spec::valley::e25(width, whole)
            } else {
                spec::valley::e25_printed(width, whole)
            };
            let core = f64::from(kinect(0.25, 0.3).share((width as f32).to_radians()));
            let [share, core] = [share, core].map(|share| number(share * i.number(greatest)));
            let names = match variant {
                "printed" => vec![printed, exact],
                _ => vec![derived],
            };
            let with = |value: &Value| names.iter().map(|name| (*name, value.clone())).collect();
            Computed {
                reference: with(&share),
                core: Some(with(&core)),
            }
        }
        ("S3.T4T5.time", "printed") => {
            let [distance, heading, speed, turn_rate] =
                ["d_m", "heading_deg", "v", "omega"].map(|name| i.number(name));
            let time = number(spec::valley::time(distance, heading, speed, turn_rate));
            Computed {
                reference: vec![("time_printed_s", time.clone()), ("time_identity_s", time)],
                core: None,
            }
        }
        //= valley.INV-8
        ("S3.select", "printed") => {
            let candidates: Vec<f64> = i.0["candidates_deg"]
                .as_array()
                .expect("candidates")
                .iter()
                .map(|candidate| candidate.as_f64().expect("a heading"))
                .collect();
            let aim = i.0["waypoint_deg"].as_f64().unwrap_or(0.0);
            let nearest = spec::valley::nearest(&candidates, aim);
            Computed {
                reference: vec![("heading_deg", nearest.map_or(Value::Null, number))],
                core: None,
            }
        }
        _ => return None,
    };
    Some(computed)
}

/// Two numbers as the core takes them.
fn pair(numbers: &[f64]) -> [f32; 2] {
    [numbers[0] as f32, numbers[1] as f32]
}

fn belief(weights: &[f64]) -> Result<decide::Belief<2>, decide::NoBelief> {
    decide::Belief::from_weights(&pair(weights))
}

fn probabilities(belief: decide::Belief<2>) -> Vec<f64> {
    [0, 1]
        .map(|state| f64::from(belief.probability(state)))
        .to_vec()
}

fn table(rows: &[[f64; 2]]) -> Vec<Vec<f64>> {
    rows.iter().map(|row| row.to_vec()).collect()
}

/// A result equals what is expected, numbers within `tolerance`; angles on the circle.
fn agrees(name: &str, found: &Value, expected: &Value, tolerance: f64) -> bool {
    match (found.as_f64(), expected.as_f64()) {
        (Some(found), Some(expected)) => {
            let circle = if name.ends_with("_rad") {
                std::f64::consts::TAU
            } else if name.ends_with("_deg") {
                360.0
            } else {
                f64::INFINITY
            };
            let difference = (found - expected).abs();
            difference <= tolerance || (circle - difference).abs() <= tolerance
        }
        _ => found == expected,
    }
}

/// S4, in millimetres and degrees; the core's metres are converted.
fn edge(equation: &str, variant: &str, i: &Input) -> Option<Computed> {
    let metres = |mm: f64| (mm / 1000.0) as f32;
    let range = |mm: f64| Length::metres(metres(mm)).expect("a range");
    let pair = |value: &Value| [0, 1].map(|k| value[k].as_f64().expect("a number"));
    let config = |range_max: f64, distance_max: f64| {
        EdgeConfig::new(edge::Parameters {
            range_max: metres(range_max),
            distance_max: metres(distance_max),
            ..PAPER
        })
        .expect("a configuration")
    };
    let computed = match (equation, variant) {
        //= edge.INV-1
        ("S4.E1", "lit") => {
            let (r, most) = (i.number("r_mm"), i.number("range_max_mm"));
            let core = edge::nearness(range(r), &config(most, 300.0));
            Computed {
                reference: vec![("N1", number(spec::edge::e1_printed(r, most)))],
                core: Some(vec![("N1", number(f64::from(core)))]),
            }
        }
        //= edge.INV-2
        ("S4.E2", variant @ ("lit" | "rec")) => {
            let (d, most) = (i.number("d_mm"), i.number("d_max_mm"));
            let core = edge::closeness(metres(d), &config(600.0, most));
            if variant == "lit" {
                Computed {
                    reference: vec![("N2", number(spec::edge::e2_printed(d, most)))],
                    // Where the paper has 0, the core has nothing.
                    core: core.map(|n2| vec![("N2", number(f64::from(n2)))]),
                }
            } else {
                let outputs = |n2: Option<f64>| {
                    vec![
                        ("N2", number(n2.unwrap_or(0.0))),
                        ("detector_valid", Value::from(n2.is_some())),
                    ]
                };
                Computed {
                    reference: outputs(spec::edge::e2(d, most)),
                    core: Some(outputs(core.map(f64::from))),
                }
            }
        }
        //= edge.INV-3
        //= edge.INV-7
        ("S4.E4", "rec") => {
            let (r, d, alpha) = (i.number("r_mm"), i.number("d_mm"), i.number("alpha_deg"));
            let (most, off) = (i.number("range_max_mm"), i.number("d_max_mm"));
            let n1 = spec::edge::e1(r, most).expect("a range");
            let n2 = spec::edge::e2(d, off).expect("within d_max");
            let p = spec::edge::e4(n1, n2, alpha);
            let threshold = i.number("threshold");
            let config = config(most, off);
            let closeness = edge::closeness(metres(d), &config).expect("within d_max");
            let cosine = alpha.to_radians().cos() as f32;
            let core = edge::projection(edge::nearness(range(r), &config), closeness, cosine);
            Computed {
                reference: vec![
                    ("Nf", number(n1 * n2)),
                    ("P_signed", number(spec::edge::e4_printed(n1 * n2, alpha))),
                    ("P", number(p)),
                    ("detect", Value::from(p > threshold)),
                ],
                core: Some(vec![
                    ("P", number(f64::from(core))),
                    ("detect", Value::from(core > config.threshold)),
                ]),
            }
        }
        ("S4.T1", "printed") => {
            let (r, d, alpha) = (i.number("r_mm"), i.number("d_mm"), i.number("alpha_deg"));
            let n1 = spec::edge::e1(r, 600.0).expect("a range");
            let n2 = spec::edge::e2(d, 300.0).expect("within d_max");
            let p = number(spec::edge::e4(n1, n2, alpha));
            Computed {
                reference: vec![("P_printed", p.clone()), ("P_exact", p)],
                core: None,
            }
        }
        ("S4.alpha", "rec") => {
            let axis = i.number("sonar_axis_deg");
            let alpha = spec::edge::alpha(i.number("heading_deg"), i.number("AE_deg"), axis);
            Computed {
                reference: vec![
                    ("alpha_deg", number(alpha)),
                    ("cos_alpha", number(alpha.to_radians().cos())),
                ],
                core: None,
            }
        }
        ("S4.AE", "rec") => {
            let (robot, ends) = (pair(&i.0["robot_xy"]), &i.0["DE"]);
            let (start, end) = (pair(&ends[0]), pair(&ends[1]));
            let (d, direction) = spec::edge::actual_edge(robot, start, end);
            let point = |at: [f64; 2]| nalgebra::Vector2::new(metres(at[0]), metres(at[1]));
            let planned = PlannedEdge::new(point(start), point(end)).expect("an edge");
            let pose = Pose {
                position: point(robot),
                heading: Angle::ZERO,
            };
            let actual = ActualEdge::new(&pose, &planned).expect("an actual edge");
            let bearing = f64::from(actual.heading_error().get()).to_degrees();
            Computed {
                reference: vec![("d_mm", number(d)), ("AE_deg", number(direction))],
                core: Some(vec![
                    ("d_mm", number(f64::from(actual.distance.abs()) * 1000.0)),
                    ("AE_deg", number(bearing)),
                ]),
            }
        }
        //= edge.INV-5
        ("S4.wall_bound", "derived") => {
            let (width, d) = (i.number("W_mm"), i.number("d_mm"));
            let rho = i.number("rho_mm");
            let n2 = spec::edge::e2(d, 300.0).expect("within d_max");
            let bound = spec::edge::ray_wall_bound(width, d, rho, 600.0, n2);
            Computed {
                reference: vec![
                    ("kappa", number((width / 2.0 - d - rho) / 600.0)),
                    ("P_wall_max_ray", number(bound)),
                ],
                core: None,
            }
        }
        //= edge.INV-4
        ("S4.detect_range", "derived") => {
            let (d, alpha) = (i.number("d_mm"), i.number("alpha_deg"));
            let threshold = i.number("threshold");
            let found = spec::edge::detection_range(d, alpha, threshold, 600.0, 300.0);
            Computed {
                reference: vec![("r_detect_mm", number(found.unwrap_or(f64::NAN)))],
                core: None,
            }
        }
        //= edge.INV-13
        ("S4.freeway", "rec") => {
            let ([right, left], safe) = (pair(&i.0["gap_mm"]), i.number("safe_path_mm"));
            let (width, middle, passable) = spec::edge::free_gap(right, left, safe);
            let gap = Gap {
                right: metres(right),
                left: metres(left),
            };
            Computed {
                reference: vec![
                    ("width_mm", number(width)),
                    ("passable", Value::from(passable)),
                    ("sub_route_y_mm", number(middle)),
                ],
                core: Some(vec![
                    ("width_mm", number(f64::from(gap.width()) * 1000.0)),
                    ("passable", Value::from(gap.is_passable(metres(safe)))),
                    ("sub_route_y_mm", number(f64::from(gap.middle()) * 1000.0)),
                ]),
            }
        }
        _ => return None,
    };
    Some(computed)
}

/// The values inside lists and objects, by their names and places: `regions.0.R_av`.
fn flatten(prefix: &str, value: &Value) -> BTreeMap<String, Value> {
    let inside: Vec<(String, &Value)> = match value {
        Value::Object(fields) => fields
            .iter()
            .map(|(key, value)| (key.clone(), value))
            .collect(),
        Value::Array(values) => {
            let places = values.iter().enumerate();
            places.map(|(i, value)| (i.to_string(), value)).collect()
        }
        value => return BTreeMap::from([(prefix.to_owned(), value.clone())]),
    };
    let dot = if prefix.is_empty() { "" } else { "." };
    inside
        .into_iter()
        .flat_map(|(key, value)| flatten(&format!("{prefix}{dot}{key}"), value))
        .collect()
}

/// The outputs that differ from what is expected; every output the core gives is looked at, and
/// every expected output must be given by the reference.
fn differences(case: &Value, outputs: &Outputs, core: bool) -> Vec<String> {
    // Lists of results are compared one by one, by name.
    let expected = flatten("", &case["out"]);
    let outputs: BTreeMap<String, Value> = outputs
        .iter()
        .flat_map(|(name, value)| flatten(name, value))
        .collect();
    let tol = case["tol"].as_f64().unwrap_or(0.0);
    let largest_angle = outputs
        .iter()
        .filter(|(name, _)| name.ends_with("_rad"))
        .filter_map(|(_, value)| value.as_f64())
        .fold(0.0, |largest: f64, angle| largest.max(angle.abs()));
    let mut wrong = Vec::new();
    for (name, value) in &outputs {
        let Some(expected) = expected.get(name) else {
            wrong.push(format!("{name} is not expected"));
            continue;
        };
        let scale = if name.ends_with("_rad") {
            largest_angle
        } else {
            expected.as_f64().unwrap_or(0.0).abs()
        };
        // f32 keeps seven digits of an angle as large as half a turn; 360° − x has lost them.
        let scale = if name.ends_with("_deg") {
            scale.max(180.0)
        } else {
            scale
        };
        // N1 is the difference of two ranges, which f32 keeps to seven digits of the larger.
        let scale = if name.rsplit('.').next() == Some("N1") {
            scale.max(10.0)
        } else {
            scale
        };
        let tolerance = if core { tol.max(2e-5 * scale) } else { tol };
        if !agrees(name, value, expected, tolerance) {
            wrong.push(format!(
                "{name}: {value}, expected {expected} ± {tolerance:e}"
            ));
        }
    }
    for name in expected.keys() {
        if !core && !outputs.contains_key(name) {
            wrong.push(format!("{name} is not computed"));
        }
    }
    wrong
}

#[test]
fn golden() {
    let path = std::env::var("SIDESTEP_GOLDEN")
        .unwrap_or_else(|_| concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden.json").to_owned());
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
    let file: Value = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{path}: {error}"));
    let cases = file["cases"].as_array().expect("cases");
    let (mut passed, mut by_core) = (0, 0);
    let mut failed = Vec::new();
    let mut missing: BTreeMap<String, usize> = BTreeMap::new();
    for case in cases {
        let (equation, variant) = (case["eq"].as_str(), case["var"].as_str());
        let (equation, variant) = (equation.expect("eq"), variant.expect("var"));
        let computed = std::panic::catch_unwind(|| compute(equation, variant, &Input(&case["in"])));
        let computed = match computed {
            Ok(Some(computed)) => computed,
            Ok(None) => {
                *missing.entry(format!("{equation} {variant}")).or_default() += 1;
                continue;
            }
            Err(_) => {
                failed.push(format!("{}: its input cannot be read", case["id"]));
                continue;
            }
        };
        let mut wrong = differences(case, &computed.reference, false);
        if let Some(core) = &computed.core {
            by_core += 1;
            wrong.extend(
                differences(case, core, true)
                    .into_iter()
                    .map(|line| format!("core {line}")),
            );
        }
        if wrong.is_empty() {
            passed += 1;
        } else {
            failed.push(format!("{}: {}", case["id"], wrong.join("; ")));
        }
    }
    for line in &failed {
        println!("{line}");
    }
    for (equation, count) in &missing {
        println!("not implemented yet: {equation}, {count} cases");
    }
    println!("{by_core} of the cases were put to the core as well");
    println!("golden: {passed} passed, {} failed", failed.len());
    assert!(passed > 0, "no case of an implemented equation in {path}");
    assert!(failed.is_empty(), "{} golden cases failed", failed.len());
}
