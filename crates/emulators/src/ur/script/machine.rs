//! Runs programs: threads take turns, and each goes on until it waits.

use std::collections::HashMap;

use super::calls::{Answer, Arguments, Controller, Wait};
use super::steps::{Program, Step};
use super::value::Value;

/// So many steps of one thread within one period are a loop that waits for nothing.
const ENDLESS: usize = 100_000;
/// Functions within functions.
const DEEPEST: usize = 64;

#[derive(Clone, Debug)]
struct Scope {
    back: usize,
    locals: HashMap<String, Value>,
}

#[derive(Clone, Debug)]
struct Thread {
    at: usize,
    stack: Vec<Value>,
    scopes: Vec<Scope>,
    wait: Wait,
}

/// A running program.
#[derive(Clone, Debug)]
pub(crate) struct Machine {
    program: Program,
    globals: HashMap<String, Value>,
    threads: Vec<Option<Thread>>,
    /// The thread that runs now; its place is empty meanwhile, and not free.
    running: usize,
}

impl Machine {
    /// At its beginning.
    pub(crate) fn new(program: Program) -> Self {
        let main = Thread {
            at: program.entry,
            stack: Vec::new(),
            scopes: vec![Scope { back: usize::MAX, locals: HashMap::new() }],
            wait: Wait::No,
        };
        Self { program, globals: HashMap::new(), threads: vec![Some(main)], running: 0 }
    }

    /// The program's name.
    pub(crate) fn name(&self) -> &str {
        &self.program.name
    }

    /// One period of `period` s. False once the main thread has ended, with which all end.
    pub(crate) fn tick(&mut self, controller: &mut dyn Controller, period: f64) -> Result<bool, String> {
        for number in 0..self.threads.len() {
            let Some(mut thread) = self.threads[number].take() else {
                continue;
            };
            self.running = number;
            let ready = match &mut thread.wait {
                Wait::No | Wait::Period => true,
                Wait::Time(left) => {
                    *left -= period;
                    *left <= 1e-9
                }
                Wait::Motion(count) => controller.over(*count),
            };
            if ready {
                thread.wait = Wait::No;
                let goes_on = self.run(&mut thread, controller).map_err(|cause| {
                    let line = self.program.lines.get(thread.at.saturating_sub(1)).copied().unwrap_or_default();
                    format!("{}: line {line}: {cause}", self.program.name)
                })?;
                if !goes_on {
                    if number == 0 {
                        return Ok(false);
                    }
                    continue;
                }
            }
            self.threads[number] = Some(thread);
        }
        Ok(true)
    }

    /// Until it waits (true) or ends (false).
    fn run(&mut self, thread: &mut Thread, controller: &mut dyn Controller) -> Result<bool, String> {
        for _ in 0..ENDLESS {
            let Some(step) = self.program.steps.get(thread.at).cloned() else {
                return Ok(false);
            };
            thread.at += 1;
            match step {
                Step::Halt => return Ok(false),
                Step::Return => {
                    let back = thread.scopes.pop().map_or(usize::MAX, |scope| scope.back);
                    if back == usize::MAX {
                        return Ok(false);
                    }
                    thread.at = back;
                }
                Step::Jump(to) => thread.at = to,
                Step::JumpUnless(to) => {
                    if !pop(thread)?.truth()? {
                        thread.at = to;
                    }
                }
                Step::Call(name, names) => self.call(thread, &name, &names, controller)?,
                Step::Spawn(name, count) => self.spawn(thread, &name, count)?,
                Step::Kill => {
                    if let Value::Thread(number) = pop(thread)? {
                        self.threads[number] = None;
                    }
                }
                Step::Join => {
                    let value = pop(thread)?;
                    if matches!(value, Value::Thread(number) if self.threads[number].is_some()) {
                        thread.stack.push(value);
                        thread.at -= 1;
                        thread.wait = Wait::Period;
                    }
                }
                step => self.data(thread, step)?,
            }
            if thread.wait != Wait::No {
                return Ok(true);
            }
        }
        Err("a loop waits for nothing: it needs sync()".to_owned())
    }

    fn data(&mut self, thread: &mut Thread, step: Step) -> Result<(), String> {
        match step {
            Step::Push(value) => thread.stack.push(value),
            Step::Drop => drop(pop(thread)?),
            Step::Load(name) => {
                let value = self.place(thread, &name).cloned().ok_or_else(|| format!("{name} is not defined"))?;
                thread.stack.push(value);
            }
            Step::Store(name) => {
                let value = pop(thread)?;
                match self.place(thread, &name) {
                    Some(place) => *place = value,
                    None => store_local(thread, name, value),
                }
            }
            Step::StoreLocal(name) => {
                let value = pop(thread)?;
                store_local(thread, name, value);
            }
            Step::StoreGlobal(name) => drop(self.globals.insert(name, pop(thread)?)),
            Step::StoreAt(name) => {
                let (value, index) = (pop(thread)?, pop(thread)?.number()?);
                self.place(thread, &name).ok_or_else(|| format!("{name} is not defined"))?.set(index, value)?;
            }
            Step::At => {
                let index = pop(thread)?.number()?;
                let value = pop(thread)?.at(index)?;
                thread.stack.push(value);
            }
            Step::List(count) => {
                let list = thread.stack.split_off(thread.stack.len().saturating_sub(count));
                thread.stack.push(Value::List(list));
            }
            Step::Pose => {
                let list = thread.stack.split_off(thread.stack.len().saturating_sub(6));
                thread.stack.push(Value::Pose(Value::List(list).six()?));
            }
            Step::Negate => {
                let number = pop(thread)?.number()?;
                thread.stack.push(Value::Number(-number));
            }
            Step::Not => {
                let truth = pop(thread)?.truth()?;
                thread.stack.push(Value::Truth(!truth));
            }
            Step::Binary(sign) => {
                let (right, left) = (pop(thread)?, pop(thread)?);
                thread.stack.push(binary(sign, &left, &right)?);
            }
            _ => {}
        }
        Ok(())
    }

    fn place<'a>(&'a mut self, thread: &'a mut Thread, name: &str) -> Option<&'a mut Value> {
        match thread.scopes.last_mut().and_then(|scope| scope.locals.get_mut(name)) {
            Some(value) => Some(value),
            None => self.globals.get_mut(name),
        }
    }

    fn call(
        &mut self,
        thread: &mut Thread,
        name: &str,
        names: &[Option<String>],
        controller: &mut dyn Controller,
    ) -> Result<(), String> {
        let values = thread.stack.split_off(thread.stack.len().saturating_sub(names.len()));
        if let Some(function) = self.program.functions.get(name) {
            if thread.scopes.len() > DEEPEST {
                return Err(format!("{name} calls itself too deeply"));
            }
            if function.parameters.len() != values.len() {
                return Err(format!("{name} takes {} values, not {}", function.parameters.len(), values.len()));
            }
            let locals = function.parameters.iter().cloned().zip(values).collect();
            thread.scopes.push(Scope { back: thread.at, locals });
            thread.at = function.entry;
            return Ok(());
        }
        let arguments = Arguments { values: names.iter().cloned().zip(values).collect() };
        let Answer(value, wait) = controller.call(name, &arguments).map_err(|cause| format!("{name}: {cause}"))?;
        thread.stack.push(value);
        thread.wait = wait;
        Ok(())
    }

    fn spawn(&mut self, thread: &mut Thread, name: &str, count: usize) -> Result<(), String> {
        let function = self.program.functions.get(name).ok_or_else(|| format!("there is no thread {name}"))?;
        let values = thread.stack.split_off(thread.stack.len().saturating_sub(count));
        let scope = Scope { back: usize::MAX, locals: function.parameters.iter().cloned().zip(values).collect() };
        let fresh = Thread { at: function.entry, stack: Vec::new(), scopes: vec![scope], wait: Wait::Period };
        let free = |number: &usize| *number != self.running && self.threads[*number].is_none();
        let number = (1..self.threads.len()).find(free).unwrap_or(self.threads.len());
        match self.threads.get_mut(number) {
            Some(place) => *place = Some(fresh),
            None => self.threads.push(Some(fresh)),
        }
        thread.stack.push(Value::Thread(number));
        Ok(())
    }
}

fn pop(thread: &mut Thread) -> Result<Value, String> {
    thread.stack.pop().ok_or_else(|| "a value is missing".to_owned())
}

fn store_local(thread: &mut Thread, name: String, value: Value) {
    if let Some(scope) = thread.scopes.last_mut() {
        scope.locals.insert(name, value);
    }
}

fn binary(sign: &str, left: &Value, right: &Value) -> Result<Value, String> {
    Ok(match sign {
        "==" => Value::Truth(left == right),
        "!=" => Value::Truth(left != right),
        "and" => Value::Truth(left.truth()? && right.truth()?),
        "or" => Value::Truth(left.truth()? || right.truth()?),
        "xor" => Value::Truth(left.truth()? != right.truth()?),
        "of" => right.at(left.number()?)?,
        "+" if matches!(left, Value::Text(_)) => Value::Text(format!("{left}{right}")),
        _ => {
            let (a, b) = (left.number()?, right.number()?);
            match sign {
                "<" => Value::Truth(a < b),
                ">" => Value::Truth(a > b),
                "<=" => Value::Truth(a <= b),
                ">=" => Value::Truth(a >= b),
                "+" => Value::Number(a + b),
                "-" => Value::Number(a - b),
                "*" => Value::Number(a * b),
                "/" => Value::Number(a / b),
                "%" => Value::Number(a % b),
                _ => Value::Number(a.powf(b)),
            }
        }
    })
}
