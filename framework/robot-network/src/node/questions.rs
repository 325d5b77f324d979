//! Questions to other robots, and the answers to theirs. Every question has a deadline.

use std::sync::Arc;
use std::time::{Duration, Instant};

use zenoh::Wait;
use zenoh::query::{ConsolidationMode, Queryable};

use super::{Node, NodeError, key, refused};
use crate::message::{self, Database};
use crate::package;

/// What a robot answers when it is asked, on threads of the network's. A robot that says nothing of
/// packages has none to give.
pub trait Answers: Send + Sync + 'static {
    /// What it has.
    fn database(&self) -> Database;

    /// The sealed package of a component; none if it is not given away.
    fn package(&self, _component: &str) -> Option<Vec<u8>> {
        None
    }
}

impl Node {
    /// The component databases of all robots that answer within `limit`, in the order of their
    /// names.
    ///
    /// # Errors
    /// When the network does not take the question.
    pub fn databases(&self, limit: Duration) -> Result<Vec<Database>, NodeError> {
        let answers = self.ask(&key::question("database", "*"), Vec::new(), limit)?;
        let read = |bytes: Vec<u8>| message::decode(&bytes).ok();
        let mut databases: Vec<Database> = answers.filter_map(read).collect();
        databases.sort_by(|one, other| one.robot.cmp(&other.robot));
        Ok(databases)
    }

    /// The package of a component of another robot, as it came: it is still to be opened.
    ///
    /// # Errors
    /// When there is none within `limit`, or it is larger than any package may be.
    pub fn package(
        &self,
        robot: &str,
        component: &str,
        limit: Duration,
    ) -> Result<Vec<u8>, NodeError> {
        let key = key::question("package", robot);
        let bytes = self.first_answer(&key, component.as_bytes().to_vec(), limit)?;
        match bytes.len() > package::BYTES_MAXIMUM {
            true => Err(NodeError::Answer {
                what: key,
                reason: format!("it has {} bytes", bytes.len()),
            }),
            false => Ok(bytes),
        }
    }

    fn first_answer(
        &self,
        key: &str,
        question: Vec<u8>,
        limit: Duration,
    ) -> Result<Vec<u8>, NodeError> {
        let first = self.ask(key, question, limit)?.next();
        first.ok_or_else(|| NodeError::NoAnswer {
            what: key.to_owned(),
            limit,
        })
    }

    /// Answers as they come, until all have answered or `limit` has passed.
    fn ask(
        &self,
        key: &str,
        question: Vec<u8>,
        limit: Duration,
    ) -> Result<impl Iterator<Item = Vec<u8>> + use<>, NodeError> {
        let replies = self
            .session
            .get(key)
            .payload(question)
            .consolidation(ConsolidationMode::None)
            .timeout(limit)
            .wait()
            .map_err(refused(key))?;
        let deadline = Instant::now() + limit;
        let next = move || loop {
            let left = deadline.saturating_duration_since(Instant::now());
            let reply = replies.recv_timeout(left).ok()??;
            if let Ok(sample) = reply.into_result() {
                return Some(sample.payload().to_bytes().into_owned());
            }
        };
        Ok(std::iter::from_fn(next))
    }
}

/// Answers whoever asks, as long as what is returned lives.
pub(super) fn answer(
    session: &zenoh::Session,
    robot: &str,
    answers: impl Answers,
) -> Result<Vec<Queryable<()>>, NodeError> {
    let answers = Arc::new(answers);
    let (for_database, for_package) = (Arc::clone(&answers), answers);
    Ok(vec![
        queryable(
            session,
            &key::question("database", robot),
            move |_question| message::encode(&for_database.database()).ok(),
        )?,
        queryable(session, &key::question("package", robot), move |question| {
            for_package.package(std::str::from_utf8(question).ok()?)
        })?,
    ])
}

/// Whoever asks for something that there is not gets no answer, at once.
fn queryable(
    session: &zenoh::Session,
    key: &str,
    answer: impl Fn(&[u8]) -> Option<Vec<u8>> + Send + Sync + 'static,
) -> Result<Queryable<()>, NodeError> {
    let own = key.to_owned();
    session
        .declare_queryable(key.to_owned())
        .callback(move |query| {
            let question = query.payload().map(|payload| payload.to_bytes());
            if let Some(bytes) = answer(question.as_deref().unwrap_or_default()) {
                // Who has asked may be gone.
                let _unheard = query.reply(own.as_str(), bytes).wait();
            }
        })
        .wait()
        .map_err(refused(key))
}
