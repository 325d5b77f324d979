//! `world_profile`: the simulated world that an application drives in.
//!
//! Every measure is bounded, so that no value makes the simulation divide by nothing, draw from an
//! empty range or take memory without end.

mod arena;
pub(super) mod quantity;
mod robot;

use std::path::Path;

use system_model::world::WorldSpecification;

use crate::document::Document;
use crate::node::Node;
use crate::problem::Problem;

/// The outermost element of a world file.
pub(super) const WORLD_ROOT: &str = "world_profile";

/// What came of loading a world.
#[derive(Debug)]
pub struct WorldOutcome {
    /// The world, if its file has no error.
    pub world: Option<WorldSpecification>,
    /// All problems of the file, sorted by place.
    pub problems: Vec<Problem>,
}

/// Loads a world. Its measures are those of the file, converted to SI units and radians.
pub fn load_world(path: &Path) -> WorldOutcome {
    load(&Document::open(path))
}

fn load(document: &Document) -> WorldOutcome {
    let world = document.root(&[WORLD_ROOT]).and_then(|root| {
        let world = read(&root);
        root.finish();
        world
    });
    WorldOutcome {
        world: world.filter(|_| !document.has_errors()),
        problems: document.problems(),
    }
}

/// Reads a world; none if a part of it is missing or cannot be understood.
pub(super) fn read(root: &Node<'_>) -> Option<WorldSpecification> {
    let name = root.required_value("name");
    let arena = root
        .required_child("arena")
        .and_then(|node| arena::read(&node));
    let bounds = arena.as_ref();
    let walls = arena::walls(root, bounds);
    let obstacles = arena::obstacles(root, bounds);
    let random_obstacles = root
        .child("random_obstacles")
        .map(|node| arena::random_obstacles(&node));
    let target = root
        .required_child("target")
        .and_then(|node| arena::target(&node, bounds));
    let smoke = root.child("smoke").map(|node| arena::smoke(&node));
    let robot = root
        .required_child("robot")
        .and_then(|node| robot::read(&node, bounds));
    let sonars = root
        .required_child("sonars")
        .and_then(|node| robot::sonars(&node));
    let camera = root
        .required_child("camera")
        .and_then(|node| robot::camera(&node));
    root.pass_over(&["description", "version", "copyright"]);
    Some(WorldSpecification {
        name: name?.as_str().to_owned(),
        arena: arena?,
        walls,
        obstacles,
        random_obstacles: match random_obstacles {
            Some(random_obstacles) => Some(random_obstacles?),
            None => None,
        },
        target: target?,
        smoke: match smoke {
            Some(smoke) => Some(smoke?),
            None => None,
        },
        robot: robot?,
        sonars: sonars?,
        camera: camera?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const ARENA: &str = include_str!("../../../../profiles/worlds/target_arena.xml");

    fn messages(text: &str) -> Vec<String> {
        let outcome = load(&Document::from_bytes("world.xml", text.as_bytes()));
        let problems = outcome.problems.into_iter();
        problems.map(|problem| problem.message).collect()
    }

    #[test]
    fn the_reference_arena_is_the_default_world() {
        let outcome = load(&Document::from_bytes("target_arena.xml", ARENA.as_bytes()));
        assert!(outcome.problems.is_empty(), "{:?}", outcome.problems);
        assert_eq!(outcome.world, Some(WorldSpecification::default()));
    }

    #[test]
    fn walls_and_obstacles_have_their_places() {
        // The file shows them in a comment; it must show them rightly.
        let text = ARENA
            .replace(
                "<!-- Further walls and obstacles at given places would stand here:",
                "",
            )
            .replace("</obstacles> -->", "</obstacles>");
        let outcome = load(&Document::from_bytes("world.xml", text.as_bytes()));
        assert!(outcome.problems.is_empty(), "{:?}", outcome.problems);
        let world = outcome.world.expect("a good world");
        assert_eq!((world.walls.len(), world.obstacles.len()), (1, 2));
    }

    #[test]
    fn every_bad_measure_is_named_at_once() {
        let text = ARENA
            .replace("<length_m>6.0<", "<length_m>-6<")
            .replace("noise_sigma_m>0.005<", "noise_sigma_m>-1<")
            .replace("minimum=\"5\"", "minimum=\"9\"")
            .replace("<track_m>0.120</track_m>", "")
            .replace("rate_hz", "rate_hertz")
            .replace("heading_deg=\"40\"", "heading_deg=\"400\"");
        let messages = messages(&text);
        for expected in [
            "`-6` in <length_m> is out of range",
            "`-1` in <noise_sigma_m> is out of range",
            "the minimum is larger than the maximum",
            "<robot> has no <track_m>",
            "<camera> has no <rate_hz>",
            "unknown element <rate_hertz> in <camera>",
            "`400` in attribute heading_deg of <mount> is out of range",
        ] {
            let count = messages
                .iter()
                .filter(|message| *message == expected)
                .count();
            assert!(count >= 1, "{expected} is not in {messages:#?}");
        }
    }

    #[test]
    fn robot_and_target_stand_in_the_arena() {
        let text = ARENA
            .replace("start x_m=\"0.6\"", "start x_m=\"7\"")
            .replace("highest x_m=\"5.3\"", "highest x_m=\"6.3\"");
        assert_eq!(
            messages(&text),
            [
                "this place is not in the arena",
                "this place is not in the arena"
            ]
        );
    }

    #[test]
    fn a_target_has_one_place() {
        let text = ARENA.replace("<region>", "<position x_m=\"5\" y_m=\"2\"/><region>");
        assert_eq!(
            messages(&text),
            ["<target> has both a <position> and a <region>"]
        );
    }

    #[test]
    fn every_sonar_socket_is_filled() {
        let text = ARENA
            .replacen("<sonar>", "<sonor>", 1)
            .replacen("</sonar>", "</sonor>", 1);
        assert_eq!(
            messages(&text),
            [
                "<sonars> holds 3 sonars, not 4",
                "unknown element <sonor> in <sonars>"
            ]
        );
    }
}
