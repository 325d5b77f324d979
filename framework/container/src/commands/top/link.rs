//! The connection to the running application, on a thread of its own: one that hangs must not keep the
//! terminal from answering keys.

use std::time::{Duration, Instant};

use container::control::client::{Client, ClientError};
use container::control::protocol::Inject;
use container::control::{Answer, Request};
use crossbeam::channel::{Receiver, RecvTimeoutError, Sender};
use serde_json::Value;

use super::model::{Model, Wish};
use crate::commands::operator::Target;
use crate::commands::words::word;

/// How often it is asked: fast enough to look alive. An answer takes the application well under a
/// millisecond.
const ASK_PERIOD: Duration = Duration::from_millis(250);

/// What is new.
#[derive(Debug)]
pub(super) enum News {
    /// A status.
    Status(Value),
    /// All faults, the oldest first.
    Faults(Vec<Value>),
    /// What came of a wish.
    Message(String),
    /// There is no connection: why, and for how long.
    Lost(String, Duration),
}

/// One look at the application.
///
/// # Errors
/// If there is none, or it does not answer.
pub(super) fn look(target: &Target) -> Result<Model, ClientError> {
    let mut client = target.connect()?;
    let mut model = Model::default();
    if let Some(status) = part(&mut client, &Request::Status, "status")? {
        model.take_status(status);
    }
    model.take_faults(faults(&mut client)?);
    Ok(model)
}

/// Asks and asks again, and does what is wished, until nobody wishes or listens any more.
pub(super) fn keep_asking(target: &Target, wishes: &Receiver<Wish>, news: &Sender<News>) {
    let mut link = Link {
        target,
        client: None,
        recorded: None,
        answered: Instant::now(),
    };
    loop {
        let told = match link.ask() {
            Ok(told) => told,
            Err(error) => {
                link.client = None;
                link.recorded = None;
                vec![News::Lost(error.to_string(), link.answered.elapsed())]
            }
        };
        // A view that lags has been told enough.
        if told.into_iter().any(|one| news.send(one).is_err()) {
            return;
        }
        match wishes.recv_timeout(ASK_PERIOD) {
            Ok(wish) => {
                let message = link.fulfil(&wish).unwrap_or_else(|error| error.to_string());
                if news.send(News::Message(message)).is_err() {
                    return;
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}

struct Link<'target> {
    target: &'target Target,
    client: Option<Client>,
    /// How many verdicts had been recorded when the faults were asked for last.
    recorded: Option<u64>,
    /// When the last answer came.
    answered: Instant,
}

impl Link<'_> {
    fn ask(&mut self) -> Result<Vec<News>, ClientError> {
        let mut news = Vec::new();
        let status = part(self.client()?, &Request::Status, "status")?;
        if let Some(status) = status {
            let recorded = status["verdicts_recorded"].as_u64();
            news.push(News::Status(status));
            if recorded != self.recorded {
                news.push(News::Faults(faults(self.client()?)?));
                self.recorded = recorded;
            }
        }
        self.answered = Instant::now();
        Ok(news)
    }

    /// What came of it, in words.
    fn fulfil(&mut self, wish: &Wish) -> Result<String, ClientError> {
        let (request, done) = match wish {
            Wish::Quit => return Ok(String::new()),
            Wish::Reset(component) => {
                let component = component.clone();
                let done = format!("reset of {component} ordered");
                (Request::ComponentReset { component }, done)
            }
            Wish::Stop(component) => {
                let component = component.clone();
                let done = format!("stop of {component} ordered");
                (Request::ComponentStop { component }, done)
            }
            Wish::Inject(element) => {
                let inject = Inject::Element(element.clone());
                (Request::FaultInject { inject }, "injected".to_owned())
            }
            Wish::Clear(id) => {
                let id = Some(*id);
                (Request::FaultClear { id }, "cleared".to_owned())
            }
        };
        Ok(match self.client()?.ask(&request)? {
            Answer::Refused(reason) => format!("refused: {}", word(&reason.into())),
            Answer::Done(content) => match content.get("ordered") {
                Some(id) => format!("{done}, see fault {}", word(id)),
                None => done,
            },
        })
    }

    fn client(&mut self) -> Result<&mut Client, ClientError> {
        let client = match self.client.take() {
            Some(client) => client,
            None => self.target.connect()?,
        };
        Ok(self.client.insert(client))
    }
}

/// One part of the answer to a request; none if it is refused.
fn part(client: &mut Client, request: &Request, key: &str) -> Result<Option<Value>, ClientError> {
    Ok(match client.ask(request)? {
        Answer::Done(mut content) => content.remove(key),
        Answer::Refused(_) => None,
    })
}

fn faults(client: &mut Client) -> Result<Vec<Value>, ClientError> {
    let faults = part(client, &Request::FaultList, "faults")?;
    Ok(match faults {
        Some(Value::Array(faults)) => faults,
        _ => Vec::new(),
    })
}
