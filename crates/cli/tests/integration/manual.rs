//! Help, completions and manual pages: complete, and accepted by the tools that read them.

use std::fs;
use std::process::Command;

use crate::support::Scratch;

const SHELLS: [&str; 5] = ["bash", "zsh", "fish", "powershell", "elvish"];

/// Words at the start of the lines between a heading and the next empty line.
fn listed(help: &str, heading: &str) -> Vec<String> {
    let lines = help.lines().skip_while(|line| *line != heading).skip(1);
    let lines = lines.take_while(|line| !line.is_empty());
    lines.filter_map(|line| line.split_whitespace().next().map(str::to_owned)).collect()
}

/// The program's commands, as its help has them.
fn commands(scratch: &Scratch) -> Vec<String> {
    let names = listed(&scratch.run(&["--help"]).out, "Commands:");
    assert!(names.len() > 8 && names.contains(&"run".to_owned()), "{names:?}");
    names.into_iter().filter(|name| name != "help").collect()
}

/// Long options of a command, as its help has them.
fn options(scratch: &Scratch, command: &str) -> Vec<String> {
    let help = scratch.run(&[command, "-h"]).out;
    let is_option = |line: &&str| line.trim_start().starts_with('-');
    help.lines()
        .filter(is_option)
        .filter_map(|line| Some(line[line.find("--")?..].split([' ', '=', '[']).next()?.to_owned()))
        .collect()
}

#[test]
fn completions_of_every_shell_name_every_command_and_option() {
    let scratch = Scratch::new("completions");
    for shell in SHELLS {
        let script = scratch.run(&["completions", shell]);
        assert_eq!((script.code, script.err.as_str()), (0, ""), "{shell}");
        for command in commands(&scratch) {
            assert!(script.out.contains(&command), "{shell}: {command}");
            for option in options(&scratch, &command) {
                // Fish writes `-l out` for --out.
                let name = option.trim_start_matches('-');
                assert!(
                    script.out.contains(&option) || script.out.contains(&format!("-l {name}")),
                    "{shell}: {option}"
                );
            }
        }
    }
    let bad = scratch.run(&["completions", "dash"]);
    assert!(bad.code == 2 && bad.err.contains("bash"), "{bad:?}");
}

#[test]
fn bash_accepts_its_completions_and_completes() {
    let scratch = Scratch::new("completions-bash");
    fs::write(scratch.path("pneuflex.bash"), scratch.run(&["completions", "bash"]).out).unwrap();
    let bash = |arguments: &[&str]| Command::new("bash").args(arguments).arg(scratch.path("pneuflex.bash")).output();
    // A machine without bash has nothing to check.
    let Ok(syntax) = bash(&["-n"]) else { return };
    assert!(syntax.status.success(), "{syntax:?}");
    let complete = "source \"$0\"; COMP_WORDS=(pneuflex conv); COMP_CWORD=1; _pneuflex pneuflex conv pneuflex; echo \"${COMPREPLY[@]}\"";
    let completed = bash(&["-c", complete]).unwrap();
    assert_eq!(String::from_utf8_lossy(&completed.stdout).trim(), "converge", "{completed:?}");
}

#[test]
fn the_manual_holds_every_command_and_option() {
    let scratch = Scratch::new("man");
    let whole = scratch.run(&["man"]);
    assert_eq!((whole.code, whole.err.as_str()), (0, ""));
    // Roff's hyphens.
    let whole = whole.out.replace("\\-", "-");
    assert_eq!(scratch.run(&["man", "pages"]).code, 0);
    assert_eq!(whole.matches(".TH ").count(), 1);
    assert!(whole.is_ascii() && whole.contains("Finite-element simulator"), "{whole}");
    let commands = commands(&scratch);
    assert_eq!(fs::read_dir(scratch.path("pages")).unwrap().count(), commands.len() + 1);
    let overview = fs::read_to_string(scratch.path("pages/pneuflex.1")).unwrap().replace("\\-", "-");
    for command in commands {
        let section = format!(".SH PNEUFLEX {}\n", command.to_uppercase());
        let start = whole.find(&section).unwrap_or_else(|| panic!("{command} has no section"));
        let rest = &whole[start + section.len()..];
        let own = &rest[..rest.find("\n.SH ").unwrap_or(rest.len())];
        let page =
            fs::read_to_string(scratch.path(&format!("pages/pneuflex-{command}.1"))).unwrap().replace("\\-", "-");
        assert!(page.contains(".TH pneuflex-") && overview.contains(&command), "{page}");
        for text in [own, &page] {
            assert!(text.contains("Examples:") && text.contains(&format!("pneuflex {command}")), "{command}: {text}");
            for option in options(&scratch, &command) {
                assert!(text.contains(&option), "{command}: {option} is missing in {text}");
            }
        }
    }
    fs::write(scratch.path("taken"), "x").unwrap();
    let refused = scratch.run(&["man", "taken"]);
    assert!(refused.code == 2 && refused.err.contains("taken by a file"), "{refused:?}");
}
