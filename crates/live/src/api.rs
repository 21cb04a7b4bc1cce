//! What is answered to which path.
//!
//! | path | answer |
//! |---|---|
//! | `/`, `/app.js` and the other [files](crate::assets) | the page |
//! | `/api/runs` | the runs: name, state, how far they are |
//! | `/api/runs/0` | one of them: curve, design, terms of the reward, log. `?since=EPOCH.WIDTH.POINTS` leaves out the points that a page has |
//! | `/api/runs/0/episode` | episodes of its newest controller in three dimensions, and the design that they are on |
//! | `/api/runs/0/what-if?NAME=VALUE…` | the same episode on this design and on one with other values, SI |
//! | `/api/runs/0/cost/POLICY?NAME=VALUE…` | what these values change in return and success, on more episodes, by the controller of the what-if before |
//!
//! The answers are JSON. Those of the first two have a tag, and with `If-None-Match` nothing comes where nothing is new.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use hyper::header::{HeaderMap, IF_NONE_MATCH};
use hyper::http::request::Parts;
use hyper::{Method, StatusCode};

use crate::answer::Answer;
use crate::assets;
use crate::door::{Door, Refusal, Wanted};
use crate::follow::Since;
use crate::list::List;
use crate::simulate::{Asked, What};
use crate::worker::Worker;

/// The longest path with its query, bytes.
const LONGEST_TARGET: usize = 8 << 10;
/// How long somebody waits for a simulation.
const LONGEST_WAIT: Duration = Duration::from_mins(1);

/// All that answers are made of.
pub(crate) struct Desk {
    pub(crate) door: Door,
    pub(crate) list: Mutex<List>,
    pub(crate) worker: Worker,
}

/// A path of the API.
enum Path {
    Runs,
    Run(usize),
    Episode(usize),
    WhatIf(usize),
    /// With the name of its controller.
    Cost(usize, String),
}

impl Path {
    fn read(path: &str) -> Option<Self> {
        let rest = path.strip_prefix("/api/runs")?;
        if rest.is_empty() {
            return Some(Self::Runs);
        }
        let (index, what) = rest.strip_prefix('/').map(|rest| rest.split_once('/').unwrap_or((rest, "")))?;
        // Each run has one address: no `+1`, no `01`.
        let index = index.parse().ok().filter(|number: &usize| number.to_string() == index)?;
        match what {
            "" if !rest.ends_with('/') => Some(Self::Run(index)),
            "episode" => Some(Self::Episode(index)),
            "what-if" => Some(Self::WhatIf(index)),
            _ => Some(Self::Cost(index, what.strip_prefix("cost/").filter(|name| !name.contains('/'))?.to_owned())),
        }
    }
}

impl Desk {
    /// The answer to a request; its body is not read.
    pub(crate) async fn answer(self: Arc<Self>, request: &Parts) -> Answer {
        let target = &request.uri;
        let page = assets::file(target.path());
        let wanted = if page.is_some() { Wanted::Page } else { Wanted::Data };
        if let Err(refusal) = self.door.check(&request.headers, wanted) {
            return refused(refusal);
        }
        if target.authority().is_some() {
            return Answer::fault(StatusCode::BAD_REQUEST, "this server is no proxy");
        }
        if target.path_and_query().is_some_and(|text| text.as_str().len() > LONGEST_TARGET) {
            return Answer::fault(StatusCode::URI_TOO_LONG, "the address is too long");
        }
        if request.method != Method::GET {
            return Answer::fault(StatusCode::METHOD_NOT_ALLOWED, "this server only answers GET");
        }
        if let Some(page) = page {
            return page;
        }
        let Some(path) = Path::read(target.path()) else { return nothing("nothing is at this address") };
        let query = target.query().unwrap_or_default();
        let (index, what) = match path {
            Path::Runs | Path::Run(_) => {
                let (since, tag) = (since(query), known(&request.headers));
                let read = tokio::task::spawn_blocking(move || self.read(&path, &since, tag.as_deref()));
                return read.await.unwrap_or_else(|_| unread());
            }
            Path::Episode(index) => (index, Ok(What::Episode)),
            Path::WhatIf(index) => (index, values(query).map(What::Changed)),
            Path::Cost(index, policy) => (index, values(query).map(|values| What::Cost(policy, values))),
        };
        let what = match what {
            Ok(what) => what,
            Err(error) => return Answer::fault(StatusCode::BAD_REQUEST, &error),
        };
        let desk = Arc::clone(&self);
        let asked = tokio::task::spawn_blocking(move || desk.asked(index, what)).await;
        match asked {
            Ok(Ok(asked)) => tokio::time::timeout(LONGEST_WAIT, self.worker.answer(asked)).await.unwrap_or_else(|_| {
                Answer::fault(StatusCode::GATEWAY_TIMEOUT, "the simulation takes longer than a minute")
            }),
            Ok(Err(fault)) => fault,
            Err(_) => unread(),
        }
    }

    /// What the run folders say.
    fn read(&self, path: &Path, since: &Since, tag: Option<&str>) -> Answer {
        let mut list = self.list.lock().unwrap_or_else(PoisonError::into_inner);
        list.refresh();
        let version = match path {
            Path::Run(index) => list.run(*index).map(|run| run.version),
            _ => Some(list.version()),
        };
        let Some(version) = version else { return nothing("no run has this number") };
        let now = format!("\"{}-{version}\"", list.server);
        if tag == Some(&now) {
            return Answer::unchanged(now);
        }
        let answer = match path {
            Path::Run(index) => list.detail(*index, since).map(|detail| Answer::json(&detail)),
            _ => Some(Answer::json(&list.listed())),
        };
        answer.map_or_else(|| nothing("no run has this number"), |answer| answer.tagged(now))
    }

    /// A simulation of the newest controller of a run.
    fn asked(&self, index: usize, what: What) -> Result<Asked, Answer> {
        let mut list = self.list.lock().unwrap_or_else(PoisonError::into_inner);
        list.refresh();
        let run = list.run(index).ok_or_else(|| nothing("no run has this number"))?;
        if let Some(why) = run.unsimulated() {
            return Err(Answer::fault(StatusCode::CONFLICT, why));
        }
        Ok(Asked { run: run.path.clone(), experiment: run.experiment(), policy: run.policy, what })
    }
}

fn nothing(why: &str) -> Answer {
    Answer::fault(StatusCode::NOT_FOUND, why)
}

fn unread() -> Answer {
    Answer::fault(
        StatusCode::INTERNAL_SERVER_ERROR,
        "the run folders could not be read; the program's own output may say why",
    )
}

fn refused(refusal: Refusal) -> Answer {
    let (status, why) = match refusal {
        Refusal::Host => (
            StatusCode::MISDIRECTED_REQUEST,
            "this server has another name; open it as localhost, or name it with --host when it starts",
        ),
        Refusal::Site => (StatusCode::FORBIDDEN, "another site may not read this"),
        Refusal::Token => {
            (StatusCode::UNAUTHORIZED, "the token is missing or wrong; open the address that the program printed")
        }
    };
    Answer::fault(status, why)
}

/// The tag of what a page has.
fn known(headers: &HeaderMap) -> Option<String> {
    Some(headers.get(IF_NONE_MATCH)?.to_str().ok()?.to_owned())
}

/// The points of a curve that a page has; none where that is said in another way.
fn since(query: &str) -> Since {
    let value = form_urlencoded::parse(query.as_bytes()).find(|(name, _)| name == "since").map(|(_, value)| value);
    let read = |text: &str| {
        let mut parts = text.split('.');
        let (epoch, width, points) = (parts.next()?, parts.next()?, parts.next()?);
        Some(Since { epoch: epoch.to_owned(), width: width.parse().ok()?, points: points.parse().ok()? })
    };
    value.and_then(|text| read(&text)).unwrap_or_default()
}

/// The design values of a query, by their names.
fn values(query: &str) -> Result<Vec<(String, f64)>, String> {
    let mut values = Vec::new();
    for (name, text) in form_urlencoded::parse(query.as_bytes()) {
        let value = text.parse().ok().filter(|value: &f64| value.is_finite());
        let value = value.ok_or_else(|| format!("{name}: `{text}` is not a number"))?;
        values.push((name.into_owned(), value));
    }
    values.sort_by(|a, b| a.0.cmp(&b.0));
    match values.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        Some(pair) => Err(format!("{} is there twice", pair[0].0)),
        None => Ok(values),
    }
}
