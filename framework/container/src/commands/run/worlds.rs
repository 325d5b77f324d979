//! The worlds of a run: made of their files before it, drawn after it.

use std::path::{Path, PathBuf};

use container::system::Application;
use container::world::{Worlds, world_files, world_seed};
use robot_simulation::Simulation;
use system_profile::load_world;

use super::{Failed, errors_on_terminal, exit_code, problems, show, unwritable, write};

/// The files of the worlds that the applications drive in, each once.
pub(super) fn files(applications: &[Application]) -> Vec<PathBuf> {
    let specifications = applications.iter().map(|it| &it.specification);
    world_files(specifications.map(|it| it.world.as_deref()))
}

/// The worlds of these files, each with a seed of its own.
pub(super) fn simulate(applications: &[Application], seed: u64) -> Result<Vec<Simulation>, Failed> {
    let files = files(applications);
    let numbered = files.iter().enumerate();
    numbered
        .map(|(number, file)| simulation(file, world_seed(seed, number)))
        .collect()
}

/// The run of a world.
pub(in crate::commands) fn simulation(path: &Path, seed: u64) -> Result<Simulation, Failed> {
    let outcome = load_world(path);
    let Some(world) = outcome.world else {
        return Err(Failed {
            code: exit_code::PROFILE,
            text: problems::render(&outcome.problems, errors_on_terminal()),
        });
    };
    show(&outcome.problems);
    Simulation::new(&world, seed).map_err(|error| Failed {
        code: exit_code::PROFILE,
        text: format!(
            "{}: {error}\n  help: mend the world, or leave <world> out of the application",
            path.display()
        ),
    })
}

/// Draws the drive in the first world to `path`; those in other worlds beside it.
pub(super) fn draw_all(path: &Path, worlds: &Worlds) -> Result<(), Failed> {
    for (number, (application, world)) in worlds.by_application().enumerate() {
        let path = match number {
            0 => path.to_owned(),
            _ => beside(path, application),
        };
        let picture = world.picture();
        let picture = picture.map_err(|error| unwritable(Some(&path), &error))?;
        write(&path, picture.as_bytes())?;
    }
    Ok(())
}

/// `drive-APPLICATION.svg` beside `drive.svg`.
fn beside(path: &Path, application: &str) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let ending = path.extension();
    let ending = ending.map_or_else(String::new, |it| format!(".{}", it.to_string_lossy()));
    path.with_file_name(format!("{stem}-{application}{ending}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn further_pictures_lie_beside_the_first() {
        for (path, expected) in [
            ("a/drive.svg", "a/drive-r2.svg"),
            ("drive", "drive-r2"),
            ("drive.1.svg", "drive.1-r2.svg"),
        ] {
            assert_eq!(beside(Path::new(path), "r2"), Path::new(expected));
        }
    }
}
