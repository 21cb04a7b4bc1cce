//! What programs do, by small ones.

use proptest::prelude::*;

use super::*;

/// A controller that knows a handful of functions and remembers what was said.
#[derive(Default)]
struct Ear {
    said: Vec<String>,
    motion: u64,
}

impl Controller for Ear {
    fn call(&mut self, name: &str, arguments: &Arguments) -> Result<Answer, String> {
        let wait = match name {
            "sync" => Wait::Period,
            "sleep" => Wait::Time(arguments.need(0, "t")?.number()?),
            "move" => {
                self.motion += 1;
                Wait::Motion(self.motion)
            }
            "say" => {
                self.said.push(arguments.text());
                Wait::No
            }
            "add" => {
                let sum = arguments.number_or(0, "a", 1.0)? + arguments.number_or(1, "b", 10.0)?;
                return Ok(Answer(Value::Number(sum), Wait::No));
            }
            _ => return Err("not known".to_owned()),
        };
        Ok(Answer(Value::Nothing, wait))
    }

    fn over(&self, motion: u64) -> bool {
        self.motion != motion
    }
}

/// What a program has said after so many periods of 8 ms, and whether it still runs.
fn run(text: &str, periods: usize) -> (Vec<String>, Result<bool, String>) {
    let (mut ear, mut machine) = (Ear::default(), Machine::new(compile(text).expect("a program")));
    let mut end = Ok(true);
    for _ in 0..periods {
        end = machine.tick(&mut ear, 0.008);
        if end != Ok(true) {
            break;
        }
    }
    (ear.said, end)
}

#[test]
fn arithmetic_names_and_functions() {
    let text = r#"
def main():
  global total = 2 + 3 * 4 - -1
  def twice(x):
    return 2 * x
  end
  local pose = p[1, 2, 3, 4, 5, 6]
  pose[1] = twice(total)
  p = [7, 8, 9]
  say(pose[1], " ", p[2], " ", add(b=2), " ", add(5))
  if not total == 15:
    say("odd")
  elif total > 14 and pose[0] < 2:
    say("right ", pose)
  else:
    say("odd")
  end
end
"#;
    let (said, end) = run(text, 3);
    assert_eq!(said, ["30 9 3 15", "right p[1, 30, 3, 4, 5, 6]"]);
    assert_eq!(end, Ok(false), "it has ended");
}

#[test]
fn functions_change_global_names_and_keep_their_own() {
    let text = r"
def main():
  global count = 0
  def up():
    count = count + 1
    own = 5
  end
  up()
  up()
  say(count)
  own = own + 1
end
";
    let (said, end) = run(text, 3);
    assert_eq!(said, ["2"]);
    assert!(end.unwrap_err().contains("line 11: own is not defined"));
}

#[test]
fn an_assignment_may_go_on_after_a_comment_and_the_next_follow_it() {
    // So ur_rtde fills in its register offsets.
    let text = "def main():\n  global a = # offset\n24  global b = # offset\n3  global c = 2\n  say(a + b * c)\nend\n";
    assert_eq!(run(text, 1).0, ["30"]);
}

#[test]
fn threads_take_turns_are_killed_and_joined() {
    let text = r#"
def main():
  global ticks = 0
  thread clock():
    while True:
      ticks = ticks + 1
      sync()
    end
  end
  thread brief():
    sleep(0.02)
    say("brief")
  end
  runner = run clock()
  other = run brief()
  join other
  say(ticks)
  kill runner
  sleep(0.1)
  say(ticks)
end
"#;
    let (said, end) = run(text, 40);
    assert_eq!(said[0], "brief");
    assert_eq!(said[1], said[2], "a killed thread ticks no more: {said:?}");
    assert_eq!(end, Ok(false));
}

#[test]
fn loops_break_continue_and_are_not_endless() {
    let text = "def main():\n  i = 0\n  while True:\n    i = i + 1\n    if i == 2:\n      continue\n    end\n    if i > 3:\n      break\n    end\n    say(i)\n  end\nend\n";
    assert_eq!(run(text, 1).0, ["1", "3"]);
    let (_, end) = run("def main():\n  while True:\n    x = 1\n  end\nend\n", 1);
    assert!(end.unwrap_err().contains("a loop waits for nothing"));
}

#[test]
fn faults_name_their_line() {
    for (text, word) in [
        ("def main():\n  fly()\nend\n", "line 2: fly: not known"),
        ("def main():\n  x = [1, 2]\n  say(x[2])\nend\n", "line 3: [1, 2] has no element 2"),
        ("def main():\n  if 1:\n  end\nend\n", "line 2: 1 is neither True nor False"),
    ] {
        let cause = run(text, 2).1.unwrap_err();
        assert!(cause.contains(word), "{cause}");
    }
    for (text, word) in [
        ("def main():\n  if True\n  end\nend\n", "line 2"),
        ("def main():\n  x = 1\n", "\"end\" is missing"),
        ("def main():\n  x = p[1, 2]\nend\n", "a pose has 6 elements, not 2"),
        ("def main():\n  x = \"a\nend\n", "a text does not end"),
    ] {
        let cause = compile(text).expect_err("no program");
        assert!(cause.contains(word), "{cause}");
    }
    let deep = format!("def main():\n  x = {}1{}\nend\n", "(".repeat(5000), ")".repeat(5000));
    assert!(compile(&deep).expect_err("too deep").contains("nested deeper"));
}

proptest! {
    /// Words of the language in any order neither panic nor hang.
    #[test]
    fn any_words_are_a_program_or_none(words in prop::collection::vec(prop::sample::select(vec![
        "def", "main", "(", ")", ":", "\n", "end", "if", "else", "elif", "while", "thread", "x", "=", "p", "[", "]", ",", "1",
        "-", "not", "and", "run", "kill", "join", "True", "return", "break", "continue", "global", "\"t\"", "==", "sync", "# c\n",
    ]), 0..60)) {
        let text = format!("def main():\n{}\nend\n", words.join(" "));
        if let Ok(program) = compile(&text) {
            let (mut ear, mut machine) = (Ear::default(), Machine::new(program));
            for _ in 0..3 {
                if machine.tick(&mut ear, 0.008) != Ok(true) {
                    break;
                }
            }
        }
    }

    #[test]
    fn any_text_is_a_program_or_none(text in ".{0,200}") {
        let _ = compile(&text);
    }
}
