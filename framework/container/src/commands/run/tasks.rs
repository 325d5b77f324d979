//! The task that rules name: a file beside the rules, beside the application, or on the search path.

use std::path::{Path, PathBuf};

use container::adaptation::AttachedTask;
use system_model::profile::Located;
use system_model::rules::{AdaptRule, FaultRules};
use system_model::specification::ApplicationSpecification;
use system_profile::load_task;

use super::{Failed, errors_on_terminal, exit_code, problems, show};

/// Loads the task of an application, if its rules name one.
pub(super) fn load(
    rules: &FaultRules,
    application: &ApplicationSpecification,
    search_path: &[PathBuf],
) -> Result<Option<AttachedTask>, Failed> {
    let of_components = rules.components.iter().filter_map(|it| it.adapt.as_ref());
    let mut named = rules.adapt.iter().chain(of_components);
    let Some(rule) = named.next() else {
        return Ok(None);
    };
    if let Some(other) = named.find(|other| other.value != rule.value) {
        return Err(Failed {
            code: exit_code::PROFILE,
            text: format!(
                "{}: another task than at {}\n  help: an application does one task; name the same \
                 file and robot everywhere",
                other.place, rule.place
            ),
        });
    }
    let beside = [&rule.place.file, &application.file];
    let folders = beside.iter().filter_map(|file| file.parent());
    let mut folders = folders.chain(search_path.iter().map(PathBuf::as_path));
    let found =
        folders.find_map(|folder| Some(folder.join(&rule.value.task)).filter(|it| it.is_file()));
    let Some(path) = found else {
        return Err(Failed {
            code: exit_code::FILE,
            text: format!(
                "{}: no task '{}' beside the rules, beside the application or on --search-path\n  \
                 help: a task is a file with the root <task_profile>",
                rule.place, rule.value.task
            ),
        });
    };
    read(&path, rule).map(Some)
}

fn read(path: &Path, rule: &Located<AdaptRule>) -> Result<AttachedTask, Failed> {
    let outcome = load_task(path);
    let Some(task) = outcome.task else {
        return Err(Failed {
            code: exit_code::PROFILE,
            text: problems::render(&outcome.problems, errors_on_terminal()),
        });
    };
    show(&outcome.problems);
    let robots = task.robots.iter().map(|robot| robot.name.as_str());
    let robot = match (&rule.value.robot, task.robots.len()) {
        (None, 1) => Some(0),
        (None, _) => None,
        (Some(name), _) => robots.clone().position(|robot| robot == name),
    };
    let Some(robot) = robot else {
        let robots: Vec<&str> = robots.collect();
        return Err(Failed {
            code: exit_code::PROFILE,
            text: format!(
                "{}: on which robot of the task does the application run?\n  help: write \
                 robot=\"…\" with one of {}",
                rule.place,
                robots.join(", ")
            ),
        });
    };
    let place = rule.place.clone();
    Ok(AttachedTask { task, robot, place })
}
