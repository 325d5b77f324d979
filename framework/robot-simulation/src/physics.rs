//! The solids and the body of the robot in the physics library: motion, contact, distances, rays.

use rapier2d_f64::math::Vector;
use rapier2d_f64::parry::query;
use rapier2d_f64::prelude::{
    Collider, ColliderBuilder, ColliderHandle, PhysicsWorld, QueryFilter, Ray, RigidBody,
    RigidBodyBuilder, RigidBodyHandle,
};
use system_model::world::{ObstacleShape, Pose, Position, RobotSpecification};

use crate::arena::Arena;
use crate::body_motion::{BodyForce, BodyVelocity};

/// Between painted wood and plastic: a robot that grazes an obstacle slides along it.
const CONTACT_FRICTION: f64 = 0.3;

/// The physical world.
pub(crate) struct Physics {
    world: PhysicsWorld,
    robot: RigidBodyHandle,
    robot_outline: ColliderHandle,
    /// In the order of the arena's solids.
    solids: Vec<ColliderHandle>,
}

/// A solid that a ray meets.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RayHit {
    pub(crate) distance_m: f64,
    /// Index into the arena's solids.
    pub(crate) solid: usize,
}

impl Physics {
    pub(crate) fn new(arena: &Arena, robot: &RobotSpecification, step_s: f64) -> Self {
        let mut world = PhysicsWorld::new();
        // Seen from above: gravity presses on the wheels, not across the floor.
        world.gravity = Vector::ZERO;
        world.integration_parameters.dt = step_s;
        let solids = arena
            .solids
            .iter()
            .enumerate()
            .map(|(index, solid)| {
                let Position { x_m, y_m } = solid.outline.centre;
                let collider = outline_collider(solid.outline.shape)
                    .translation(Vector::new(x_m, y_m))
                    .friction(CONTACT_FRICTION)
                    .user_data(index as u128);
                world.insert_collider(collider, None)
            })
            .collect();
        let Position { x_m, y_m } = robot.start.position;
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::new(x_m, y_m))
            .rotation(robot.start.heading_rad)
            .can_sleep(false);
        let outline = ColliderBuilder::cuboid(robot.length_m / 2.0, robot.width_m / 2.0)
            .mass(robot.mass_kg)
            .friction(CONTACT_FRICTION);
        let (robot, robot_outline) = world.insert(body, outline);
        let mut physics = Self {
            world,
            robot,
            robot_outline,
            solids,
        };
        // Rays meet only what a step has entered into the library's search tree.
        physics.world.step();
        physics
    }

    pub(crate) fn pose(&self) -> Pose {
        let pose = self.body().position();
        Pose {
            position: Position {
                x_m: pose.translation.x,
                y_m: pose.translation.y,
            },
            heading_rad: libm::atan2(pose.rotation.sin(), pose.rotation.cos()),
        }
    }

    pub(crate) fn velocity(&self) -> BodyVelocity {
        let body = self.body();
        let velocity = body.rotation().inverse() * body.linvel();
        BodyVelocity {
            forward_m_per_s: velocity.x,
            lateral_m_per_s: velocity.y,
            turn_rad_per_s: body.angvel(),
        }
    }

    /// Moves everything on by one step under this force.
    pub(crate) fn step(&mut self, force: BodyForce) {
        let body = &mut self.world.bodies[self.robot];
        let turned = *body.rotation();
        body.reset_forces(true);
        body.reset_torques(true);
        body.add_force(turned * Vector::new(force.forward_n, force.lateral_n), true);
        body.add_torque(force.torque_n_m, true);
        self.world.step();
    }

    /// Puts a solid of the arena elsewhere; rays meet it there after the next step.
    pub(crate) fn move_solid(&mut self, solid: usize, to: Position) {
        let collider = &mut self.world.colliders[self.solids[solid]];
        collider.set_translation(Vector::new(to.x_m, to.y_m));
    }

    /// Distances in m between the outlines of the robot and of each solid of the arena; 0 where
    /// they touch.
    pub(crate) fn distances_m(&self) -> impl Iterator<Item = f64> + '_ {
        let robot = &self.world.colliders[self.robot_outline];
        self.solids
            .iter()
            .map(move |&solid| distance_between(robot, &self.world.colliders[solid]))
    }

    /// Distance to the first solid that a ray from `origin` meets.
    pub(crate) fn nearest_on_ray(
        &self,
        origin: Position,
        heading_rad: f64,
        range_m: f64,
    ) -> Option<f64> {
        let filter = QueryFilter::new().exclude_rigid_body(self.robot);
        self.world
            .cast_ray(&ray(origin, heading_rad), range_m, true, filter)
            .map(|(_, distance_m)| distance_m)
    }

    /// All solids that a ray from `origin` meets, the nearest first.
    pub(crate) fn all_on_ray(
        &self,
        origin: Position,
        heading_rad: f64,
        range_m: f64,
        hits: &mut Vec<RayHit>,
    ) {
        hits.clear();
        let filter = QueryFilter::new().exclude_rigid_body(self.robot);
        hits.extend(
            self.world
                .intersect_ray(ray(origin, heading_rad), range_m, true, filter)
                .map(|(_, collider, meeting)| RayHit {
                    distance_m: meeting.time_of_impact,
                    solid: collider.user_data as usize,
                }),
        );
        hits.sort_by(|a, b| {
            a.distance_m
                .total_cmp(&b.distance_m)
                .then(a.solid.cmp(&b.solid))
        });
    }

    fn body(&self) -> &RigidBody {
        &self.world.bodies[self.robot]
    }
}

fn outline_collider(shape: ObstacleShape) -> ColliderBuilder {
    match shape {
        ObstacleShape::Circle { radius_m } => ColliderBuilder::ball(radius_m),
        ObstacleShape::Box {
            length_m,
            width_m,
            heading_rad,
        } => ColliderBuilder::cuboid(length_m / 2.0, width_m / 2.0).rotation(heading_rad),
    }
}

fn distance_between(robot: &Collider, solid: &Collider) -> f64 {
    query::distance(
        robot.position(),
        robot.shape(),
        solid.position(),
        solid.shape(),
    )
    .expect("circles and boxes have a distance")
    .distance
}

fn ray(origin: Position, heading_rad: f64) -> Ray {
    let (sine, cosine) = libm::sincos(heading_rad);
    Ray::new(
        Vector::new(origin.x_m, origin.y_m),
        Vector::new(cosine, sine),
    )
}
