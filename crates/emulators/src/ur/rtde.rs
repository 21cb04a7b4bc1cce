//! The server of RTDE, protocol 2.

use std::collections::VecDeque;
use std::sync::mpsc::SyncSender;

use hwasp_drivers::ur::FieldType;
use hwasp_drivers::ur::wire::{Body, Frame, kind};

use super::controller::Controller;
use super::fields::{Sink, Source, input, output};

/// What one client has asked for.
#[derive(Debug)]
pub(super) struct Client {
    /// Frames go out by this, in their order.
    line: SyncSender<Vec<u8>>,
    /// Whether it speaks protocol 2.
    agreed: bool,
    started: bool,
    outputs: Vec<(FieldType, Source)>,
    /// s between packets, and the clock of the next.
    every: f64,
    next: f64,
    inputs: Vec<Vec<(FieldType, Sink)>>,
    /// Packets that are held back, with the clock at which they go.
    held: VecDeque<(f64, Vec<u8>)>,
    sent: u32,
}

impl Client {
    pub(crate) fn new(line: SyncSender<Vec<u8>>) -> Self {
        Self {
            line,
            agreed: false,
            started: false,
            outputs: Vec::new(),
            every: 0.008,
            next: 0.0,
            inputs: Vec::new(),
            held: VecDeque::new(),
            sent: 0,
        }
    }

    /// Whether it writes this register.
    pub(crate) fn writes(&self, sink: Sink) -> bool {
        sink != Sink::Nowhere && self.inputs.iter().flatten().any(|(_, own)| *own == sink)
    }

    /// Answers a frame; `used` tells what other clients write. False closes the connection.
    pub(crate) fn answer(&mut self, frame: &Frame, controller: &mut Controller, used: &dyn Fn(Sink) -> bool) -> bool {
        let mut body = Body::new(&frame.body);
        let reply: Vec<u8> = match frame.kind {
            kind::PROTOCOL => {
                self.agreed = body.u16() == Ok(2);
                vec![u8::from(self.agreed)]
            }
            kind::CONTROLLER => {
                controller.settings.generation.version().iter().flat_map(|part| part.to_be_bytes()).collect()
            }
            _ if !self.agreed => {
                controller.say("RTDE: protocol 1 is not emulated; ask for 2 first".to_owned());
                return false;
            }
            kind::OUTPUTS => self.choose_outputs(body, controller),
            kind::INPUTS => self.choose_inputs(body, used),
            kind::START => {
                self.started = !self.outputs.is_empty();
                self.next = controller.clock;
                vec![u8::from(self.started)]
            }
            kind::PAUSE => {
                self.started = false;
                vec![1]
            }
            kind::DATA => {
                let number = body.u8().unwrap_or_default();
                let recipe = usize::from(number).checked_sub(1).and_then(|at| self.inputs.get(at));
                match recipe.map(|recipe| controller.take(recipe, body)) {
                    Some(Ok(())) => {}
                    Some(Err(cause)) => controller.say(format!("RTDE: recipe {number}: {cause}")),
                    None => controller.say(format!("RTDE: there is no recipe {number}")),
                }
                return true;
            }
            other => {
                controller.say(format!("RTDE: a frame of kind {other}"));
                return true;
            }
        };
        Frame::bytes(frame.kind, &reply).is_some_and(|bytes| self.line.try_send(bytes).is_ok())
    }

    fn choose_outputs(&mut self, mut body: Body<'_>, controller: &Controller) -> Vec<u8> {
        let generation = controller.settings.generation;
        let fastest = controller.period();
        let frequency = body.f64().unwrap_or_default();
        self.every = if frequency > 0.0 { (1.0 / frequency).max(fastest) } else { fastest };
        let found: Vec<_> = names(&mut body).map(|name| output(name, generation)).collect();
        let all: Option<Vec<_>> = found.iter().copied().collect();
        let number = u8::from(all.as_ref().is_some_and(|all| !all.is_empty()));
        self.outputs = all.unwrap_or_default();
        kinds(number, found.iter().map(|field| field.map_or("NOT_FOUND", |field| field.0.name())))
    }

    fn choose_inputs(&mut self, mut body: Body<'_>, used: &dyn Fn(Sink) -> bool) -> Vec<u8> {
        let found: Vec<_> = names(&mut body).map(input).collect();
        let all: Option<Vec<_>> = found.iter().map(|field| field.filter(|field| !used(field.1))).collect();
        let words = found.iter().map(|field| match field {
            None => "NOT_FOUND",
            Some(field) if used(field.1) => "IN_USE",
            Some(field) => field.0.name(),
        });
        let mut number = 0;
        if let Some(all) = all.filter(|all| !all.is_empty() && self.inputs.len() < 255) {
            self.inputs.push(all);
            number = self.inputs.len() as u8; // from 1 on; 0 is none
        }
        kinds(number, words)
    }

    /// At the end of each period: a packet, if it is time for one.
    pub(crate) fn period(&mut self, controller: &mut Controller) {
        let faults = controller.faults;
        if self.started && controller.clock + 1e-9 >= self.next {
            self.next = (self.next + self.every).max(controller.clock - self.every);
            self.sent = self.sent.wrapping_add(1);
            let lost = faults.silent || (faults.drop > 0 && self.sent.is_multiple_of(faults.drop));
            if !lost {
                let shown = controller.shown();
                let mut body = vec![1];
                self.outputs.iter().for_each(|field| controller.write(*field, &shown, &mut body));
                if let Some(bytes) = Frame::bytes(kind::DATA, &body) {
                    self.held.push_back((controller.clock + f64::from(faults.delay) * 1e-3, bytes));
                }
            }
        }
    }

    /// Every millisecond: what has been held back long enough goes out. What a slow client does not read is skipped, as the
    /// controller does.
    pub(crate) fn release(&mut self, clock: f64) {
        while self.held.front().is_some_and(|(due, _)| *due <= clock + 1e-9) {
            if let Some((_, bytes)) = self.held.pop_front() {
                let _ = self.line.try_send(bytes);
            }
        }
    }
}

/// Names between commas; clients end the list with one, or not.
fn names<'a>(body: &mut Body<'a>) -> impl Iterator<Item = &'a str> {
    body.text().unwrap_or_default().split(',').map(str::trim).filter(|name| !name.is_empty())
}

fn kinds<'a>(number: u8, words: impl Iterator<Item = &'a str>) -> Vec<u8> {
    let words: Vec<&str> = words.collect();
    let mut reply = vec![number];
    reply.extend_from_slice(words.join(",").as_bytes());
    reply
}
