//! A method of a service is called.

use std::sync::Arc;
use std::time::Duration;

use behavior_tree::{Leaf, LeafContext, Status, Value};
use fault_manager::detection::NumberReader;

use super::{milliseconds, number};
use crate::component::SafeDatum;
use crate::mission::calls::{Call, Calls, Method};
use crate::mission::reach::Reach;

/// Calls a method, and waits for the answer in later ticks.
pub(in crate::mission) struct CallService {
    pub(in crate::mission) reach: Arc<Reach>,
    pub(in crate::mission) calls: Arc<Calls>,
    pub(in crate::mission) method: Method,
    /// The request, all zero but for the field that the node names; none without content.
    pub(in crate::mission) request: Option<SafeDatum>,
    /// The field of the reply that the node names.
    pub(in crate::mission) reply: Option<NumberReader>,
    pub(in crate::mission) under_way: Option<Arc<Call>>,
    pub(in crate::mission) deadline: Duration,
}

impl CallService {
    fn begin(&mut self, context: &LeafContext<'_>) -> Result<bool, String> {
        let timeout = milliseconds(context, "timeout_ms")?;
        self.deadline = context.now.saturating_add(timeout);
        let request: Box<[u8]> = match &mut self.request {
            None => Box::default(),
            Some(request) => {
                if context.input("value").is_some() {
                    request.set(number(context, "value")?);
                }
                request.at(self.reach.now_ns()).into()
            }
        };
        self.under_way = self.calls.ask(&self.method, request, timeout);
        Ok(self.under_way.is_some())
    }
}

impl Leaf for CallService {
    fn tick(&mut self, context: &mut LeafContext<'_>) -> Result<Status, String> {
        if context.begins && !self.begin(context)? {
            self.reach.notice("too many calls of services wait");
            return Ok(Status::Failure);
        }
        let answer = self.under_way.as_ref().and_then(|call| call.answer());
        let Some((answer, reply)) = answer else {
            return Ok(match context.now < self.deadline {
                true => Status::Running,
                false => Status::Failure,
            });
        };
        self.under_way = None;
        if !answer.is_success() {
            self.reach.notice(&format!("a service answered {answer}"));
            return Ok(Status::Failure);
        }
        if let Some(reader) = &self.reply {
            context.output("reply", Value::Number(reader.read(&reply)))?;
        }
        Ok(Status::Success)
    }

    /// The call is made all the same; nobody waits for its answer.
    fn halt(&mut self, _context: &mut LeafContext<'_>) {
        self.under_way = None;
    }
}
