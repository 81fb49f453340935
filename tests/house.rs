//! House rules: what a reader may rely on in every room, held by tests.
//!
//! Each rule is a function from text to breaches, and beside each stands a planted text that breaks it.
//!
//! - imports: manifests and sources point one way, and siblings do not know each other;
//! - sight: the engine sees no triangle, and one file opens files;
//! - size: every file says what it is, in at most 600 lines, and no function is longer than 70;
//! - citations: what is cited is in `refs.bib`, and what is there is cited;
//! - words: no path of a machine, nothing left to do, nothing unsafe.

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Lines of a file, tests in it not counted.
const FILE_LINES: usize = 600;
/// Lines of a file of tests.
const TEST_FILE_LINES: usize = 800;
/// Lines of a function, from `fn` to its last brace.
const FUNCTION_LINES: usize = 70;

/// What each member may import from this workspace. Members by folder.
const LAYERS: [(&str, &[&str]); 7] = [
    ("mt-core", &[]),
    ("operators", &["mt-core"]),
    ("selective", &["mt-core"]),
    ("render", &["mt-core"]),
    ("papers", &["mt-core", "operators", "selective", "render"]),
    ("render/viewer", &["mt-core", "operators", "selective", "render", "papers"]),
    (".", &["mt-core", "operators", "selective", "render", "papers", "viewer"]),
];

/// The three between the core and the papers, which know the core and not each other.
const SIBLINGS: [&str; 3] = ["operators", "selective", "render"];

/// Lines outside `src/files.rs` that may open a file: file, what the line contains, why.
const OPENERS: [(&str, &str, &str); 6] = [
    ("src/memory.rs", "/sys/fs/cgroup/", "and a group of processes its share"),
    ("src/memory.rs", "/proc/self/status", "the system tells a process its memory by a file, which is no input"),
    ("src/memory.rs", "/proc/self/clear_refs", "and is told so to begin anew"),
    ("src/memory.rs", "/proc/meminfo", "and the machine's"),
    (
        "src/verify/keep.rs",
        "create_dir_all(&folder)",
        "a test that fails leaves its finding, and the library has no command",
    ),
    ("src/verify/keep.rs", "fs::write(&part", "the same"),
];

/// Lines that may be unsafe: file, what the line contains, why. There are none.
const UNSAFE: [(&str, &str, &str); 0] = [];

/// Beginnings of paths that exist on one machine only. In halves, so that this file has none of them.
const MACHINE: [&str; 4] =
    [concat!("/ho", "me/"), concat!("/Us", "ers/"), concat!("/ro", "ot/"), concat!("/wo", "rk/")];

/// Words that have no place in finished sources, in any case of letters; macros with their exclamation mark.
const WORDS: [&str; 6] = [
    concat!("ses", "sion"),
    concat!("to", "do"),
    concat!("fix", "me"),
    concat!("to", "do!"),
    concat!("unimple", "mented!"),
    concat!("d", "bg!"),
];

// The house

/// A file of the workspace, by its path from the root.
struct Source {
    path: String,
    text: String,
}

impl Source {
    /// Where each place lies, as messages begin.
    fn at(&self, line: usize) -> String {
        format!("{}:{line}: ", self.path)
    }

    fn is_test(&self) -> bool {
        self.path.starts_with("tests/") || self.path.contains("/tests/") || self.path.ends_with("/tests.rs")
    }

    /// Whether it is compiled into what users get: the `src` folder of a member, less its tests.
    fn is_shipped(&self) -> bool {
        let member = LAYERS.iter().any(|&(folder, _)| {
            let folder = if folder == "." { String::new() } else { format!("{folder}/") };
            self.path.starts_with(&format!("{folder}src/"))
        });
        member && !self.is_test()
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests lie in the workspace").to_path_buf()
}

/// All files with one of these extensions, in order of their paths; none that a build or a study made.
fn sources(extensions: &[&str]) -> Vec<Source> {
    let root = root();
    let mut found = Vec::new();
    let mut folders = vec![root.clone()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder that can be read") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if path.is_dir() && !path.is_symlink() {
                if !name.starts_with('.') && name != "target" && path != root.join("study") {
                    folders.push(path);
                }
            } else if path.extension().is_some_and(|e| extensions.iter().any(|&x| e == x)) {
                let text = std::fs::read_to_string(&path).expect("sources are text");
                let inside = path.strip_prefix(&root).expect("found under the root");
                let path = inside.to_string_lossy().replace('\\', "/");
                found.push(Source { path, text });
            }
        }
    }
    found.sort_by(|a, b| a.path.cmp(&b.path));
    found
}

/// A rule over sources holds, or all that breaks it is told.
fn hold(sources: &[Source], rule: impl Fn(&Source) -> Vec<String>) {
    assert!(!sources.is_empty(), "no source was found");
    let breaches: Vec<String> = sources.iter().flat_map(rule).collect();
    assert!(breaches.is_empty(), "{} breaches:\n{}", breaches.len(), breaches.join("\n"));
}

/// What a rule says of a text by itself.
fn told(rule: impl Fn(&Source) -> Vec<String>, path: &str, text: &str) -> Vec<String> {
    rule(&Source { path: path.into(), text: text.into() })
}

// Reading Rust, as far as the rules need it

/// The text with comments, strings and characters turned into spaces. Lines stay where they are.
fn code(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let after_name = code.ends_with(is_name);
        let skipped = comment_length(rest).or_else(|| literal_length(rest, after_name));
        match skipped {
            Some(length) => code.extend(rest[..length].chars().map(|c| if c == '\n' { '\n' } else { ' ' })),
            None => code.push(first),
        }
        rest = &rest[skipped.unwrap_or(first.len_utf8())..];
    }
    code
}

fn is_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The length of the comment that the text begins with.
fn comment_length(text: &str) -> Option<usize> {
    if text.starts_with("//") {
        return Some(text.find('\n').unwrap_or(text.len()));
    }
    let mut inside = text.strip_prefix("/*")?;
    let mut depth = 1;
    while depth > 0 {
        let Some(at) = ["/*", "*/"].iter().filter_map(|mark| inside.find(mark)).min() else { return Some(text.len()) };
        depth = if inside[at..].starts_with("/*") { depth + 1 } else { depth - 1 };
        inside = &inside[at + 2..];
    }
    Some(text.len() - inside.len())
}

/// The length of the string or character that the text begins with. A quote before a name is a lifetime.
fn literal_length(text: &str, after_name: bool) -> Option<usize> {
    if let Some(inside) = text.strip_prefix('r').filter(|_| !after_name) {
        let hashes = inside.len() - inside.trim_start_matches('#').len();
        inside[hashes..].strip_prefix('"')?;
        let close = format!("\"{}", "#".repeat(hashes));
        let from = 1 + hashes + 1;
        return Some(text[from..].find(&close).map_or(text.len(), |at| from + at + close.len()));
    }
    let quote = text.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    let mut characters = text.char_indices().skip(1);
    if quote == '\'' {
        let (_, first) = characters.next()?;
        if first != '\\' {
            let (at, second) = characters.next()?;
            return (second == '\'').then_some(at + 1);
        }
        characters.next();
    }
    while let Some((at, c)) = characters.next() {
        match c {
            '\\' => drop(characters.next()),
            _ if c == quote => return Some(at + 1),
            _ => {}
        }
    }
    Some(text.len())
}

/// Where `word` stands in the text by itself, not as a part of a longer name.
fn places<'a>(text: &'a str, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    let begins_as_name = word.starts_with(is_name);
    let ends_as_name = word.ends_with(is_name);
    text.match_indices(word).map(|(at, _)| at).filter(move |&at| {
        !(begins_as_name && text[..at].ends_with(is_name)
            || ends_as_name && text[at + word.len()..].starts_with(is_name))
    })
}

fn line_of(text: &str, at: usize) -> usize {
    text[..at].matches('\n').count() + 1
}

/// The end of the item that begins at `from`: after its block, or after the semicolon if it has none.
fn item_end(code: &str, from: usize) -> usize {
    let mut brackets = 0;
    let mut braces = 0;
    for (at, c) in code[from..].char_indices() {
        match c {
            '(' | '[' => brackets += 1,
            ')' | ']' => brackets -= 1,
            '{' => braces += 1,
            '}' => braces -= 1,
            _ => {}
        }
        if brackets == 0 && braces == 0 && matches!(c, ';' | '}') {
            return from + at + 1;
        }
    }
    code.len()
}

/// The items of `code` that begin with `mark`.
fn items(code: &str, mark: &str) -> Vec<Range<usize>> {
    code.match_indices(mark).map(|(at, _)| at..item_end(code, at + mark.len())).collect()
}

/// The code with these ranges turned into spaces.
fn without(code: &str, ranges: &[Range<usize>]) -> String {
    let blank = |at, c| if c != '\n' && ranges.iter().any(|range| range.contains(&at)) { ' ' } else { c };
    code.char_indices().map(|(at, c)| blank(at, c)).collect()
}

/// The code of a source, without tests.
fn shipped_code(text: &str) -> String {
    let code = code(text);
    let tests = items(&code, "#[cfg(test)]");
    without(&code, &tests)
}

// Imports

/// The members of the workspace that a manifest names in any table of dependencies, by folder.
fn imports(manifest: &str) -> BTreeSet<String> {
    let manifest: toml::Table = manifest.parse().expect("a manifest is TOML");
    let mut tables = vec![&manifest];
    if let Some(targets) = manifest.get("target").and_then(toml::Value::as_table) {
        tables.extend(targets.values().filter_map(toml::Value::as_table));
    }
    let kinds = ["dependencies", "dev-dependencies", "build-dependencies"];
    let dependencies = tables
        .iter()
        .flat_map(|table| kinds.iter().filter_map(|&kind| table.get(kind)?.as_table()))
        .flat_map(|table| table.iter());
    dependencies.filter_map(|(key, value)| member(key, value)).collect()
}

/// The folder of the member that a line of dependencies means, by its key, its package or its path.
fn member(key: &str, value: &toml::Value) -> Option<String> {
    let package = value.get("package").and_then(toml::Value::as_str).unwrap_or(key);
    let local = value.get("path").and_then(toml::Value::as_str).map(str::to_owned);
    let folder = match package {
        "multi-tessellation" => ".",
        "mt-core" => package,
        _ => package.strip_prefix("mt-").unwrap_or(package),
    };
    let known = folder == "tests" || LAYERS.iter().any(|&(layer, _)| layer == folder);
    known.then(|| folder.to_owned()).or(local)
}

/// Rule: a member imports only what lies below it.
fn imports_below(folder: &str, manifest: &str) -> Vec<String> {
    let (_, below) = LAYERS.iter().find(|(layer, _)| *layer == folder).expect("every member has its layer");
    let above = imports(manifest).into_iter().filter(|import| !below.contains(&import.as_str()));
    above.map(|import| format!("{folder}/Cargo.toml: {import} is not below {folder}")).collect()
}

/// Rule: a source of `operators`, `selective` or `render` names neither of the other two, nor what is above.
fn siblings_unnamed(source: &Source) -> Vec<String> {
    // The window has a room in the renderer's folder, but stands above all of them.
    let is_sibling = |(home, rest): &(&str, &str)| SIBLINGS.contains(home) && !rest.starts_with("viewer/");
    let Some((home, _)) = source.path.split_once('/').filter(is_sibling) else {
        return Vec::new();
    };
    let others = SIBLINGS.iter().chain(&["papers"]).filter(|other| **other != home);
    let names = others.flat_map(|other| [format!("mt_{other}"), format!("{other}::")]);
    let names = names.chain(["multi_tessellation".to_owned()]);
    names
        .flat_map(|name| {
            let lines: Vec<usize> = places(&source.text, &name).map(|at| line_of(&source.text, at)).collect();
            lines.into_iter().map(move |line| format!("{}{home} names {name}", source.at(line)))
        })
        .collect()
}

#[test]
fn imports_point_one_way() {
    let workspace = std::fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let table: toml::Table = workspace.parse().unwrap();
    let members = table["workspace"]["members"].as_array().unwrap();
    // What judges the others may import all of them.
    let judges = |member: &str| Path::new(member).starts_with("tests");
    let members = members.iter().map(|member| member.as_str().unwrap()).filter(|&member| !judges(member));
    let mut breaches = Vec::new();
    for folder in members.chain(["."]) {
        let manifest = std::fs::read_to_string(root().join(folder).join("Cargo.toml")).unwrap();
        breaches.extend(imports_below(folder, &manifest));
    }
    assert!(breaches.is_empty(), "{}", breaches.join("\n"));
}

#[test]
fn siblings_do_not_know_each_other() {
    hold(&sources(&["rs"]), siblings_unnamed);
}

#[test]
fn planted_imports_are_found() {
    let upward =
        "[dependencies]\nmt-core.workspace = true\nglam = \"0.1\"\n[dev-dependencies]\nselective.workspace = true";
    assert_eq!(imports_below("operators", upward), ["operators/Cargo.toml: selective is not below operators"]);
    let renamed = "[target.'cfg(unix)'.dependencies]\nengine = { path = \"../selective\", package = \"mt-selective\" }";
    assert_eq!(imports_below("render", renamed).len(), 1);
    assert_eq!(imports_below("mt-core", "[build-dependencies]\nmulti-tessellation = { path = \"..\" }").len(), 1);
    assert_eq!(imports_below("mt-core", "[dependencies]\nother = { path = \"../peers\" }").len(), 1);
    assert_eq!(imports_below("papers", "[dependencies]\nrender.workspace = true\nserde = \"1\""), [""; 0]);

    let text = "//! An engine.\nuse mt_operators::EdgeCollapse;\nfn f(x: render::Look) {}\n";
    let found = told(siblings_unnamed, "selective/src/lib.rs", text);
    assert_eq!(
        found,
        ["selective/src/lib.rs:2: selective names mt_operators", "selective/src/lib.rs:3: selective names render::"]
    );
    assert_eq!(told(siblings_unnamed, "papers/src/lib.rs", text), [""; 0]);
}

// Sight

/// Rule: `selective` names nothing that only triangles in space have.
fn engine_sees_no_triangle(source: &Source) -> Vec<String> {
    if !source.path.starts_with("selective/src/") {
        return Vec::new();
    }
    let names = ["area_vector", "cone_of_cells", "Mesh<3>", "Explicit<3>", "Complex<3>", "Cell<3>"];
    let code = shipped_code(&source.text);
    let found = names.iter().flat_map(|name| places(&code, name).map(move |at| (at, name)));
    found.map(|(at, name)| format!("{}the engine names {name}", source.at(line_of(&code, at)))).collect()
}

/// Rule: of the shipped sources only `src/files.rs` opens files, and the lines in [`OPENERS`].
fn one_opener(source: &Source) -> Vec<String> {
    if !source.is_shipped() || source.path == "src/files.rs" {
        return Vec::new();
    }
    let names = ["fs", "File::open", "File::create", "File::options", "OpenOptions"];
    let code = shipped_code(&source.text);
    let lines: BTreeSet<usize> =
        names.iter().flat_map(|name| places(&code, name).map(|at| line_of(&code, at))).collect();
    let broken = lines.into_iter().filter(|&line| !excepted(source, line, &OPENERS));
    broken.map(|line| format!("{}only src/files.rs opens files", source.at(line))).collect()
}

/// Whether this line is on a list of exceptions.
fn excepted(source: &Source, line: usize, exceptions: &[(&str, &str, &str)]) -> bool {
    let text = source.text.lines().nth(line - 1).unwrap_or_default();
    exceptions.iter().any(|(path, part, _)| *path == source.path && text.contains(part))
}

#[test]
fn the_engine_sees_no_triangle() {
    hold(&sources(&["rs"]), engine_sees_no_triangle);
}

#[test]
fn one_file_opens_files() {
    let sources = sources(&["rs"]);
    hold(&sources, one_opener);
    for (path, part, reason) in OPENERS {
        let used = sources.iter().any(|source| source.path == path && source.text.contains(part));
        assert!(used && !reason.is_empty(), "the exception for {path} is needed no more");
    }
}

#[test]
fn planted_sights_are_found() {
    let text =
        "//! Engine.\n// Of a Mesh<3> one may speak.\nuse mt_core::mesh::area_vector;\nfn f(mesh: &Mesh<3>) {}\n";
    let found = told(engine_sees_no_triangle, "selective/src/lib.rs", text);
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found[0].contains(":3:") && found[1].contains(":4:"));

    let text =
        "//! Room.\nuse std::{fs, io};\nfn f() { File::open(\"x\"); }\n#[cfg(test)]\nmod tests { use std::fs; }\n";
    assert_eq!(told(one_opener, "mt-core/src/mesh.rs", text).len(), 2);
    assert_eq!(told(one_opener, "src/commands/build.rs", text).len(), 2);
    assert_eq!(told(one_opener, "src/files.rs", text), [""; 0]);
    assert_eq!(told(one_opener, "render/examples/gallery.rs", text), [""; 0]);
    let memory = "let status = std::fs::read_to_string(\"/proc/self/status\");";
    assert_eq!(told(one_opener, "src/memory.rs", memory), [""; 0]);
    assert_eq!(told(one_opener, "src/main.rs", memory).len(), 1);
}

// Size

/// Rule: a file begins by saying what it is.
fn says_what_it_is(source: &Source) -> Vec<String> {
    let first = source.text.lines().next().unwrap_or_default();
    let says = first.strip_prefix("//!").is_some_and(|said| !said.trim().is_empty());
    if says { Vec::new() } else { vec![format!("{}must begin with //! and a sentence", source.at(1))] }
}

/// Rule: a file can be read at one go.
fn short_file(source: &Source) -> Vec<String> {
    let code = code(&source.text);
    let tests: usize = items(&code, "#[cfg(test)]").iter().map(|range| code[range.clone()].lines().count()).sum();
    let lines = source.text.lines().count() - tests;
    let most = if source.is_test() { TEST_FILE_LINES } else { FILE_LINES };
    if lines <= most { Vec::new() } else { vec![format!("{}{lines} lines, {most} allowed", source.at(1))] }
}

/// Rule: a function can be seen at one glance. Bodies of macros are skipped.
fn short_functions(source: &Source) -> Vec<String> {
    let code = code(&source.text);
    let code = without(&code, &items(&code, "macro_rules!"));
    let mut breaches = Vec::new();
    for at in places(&code, "fn") {
        let name: String = code[at + 2..].trim_start().chars().take_while(|&c| is_name(c)).collect();
        let lines = code[at..item_end(&code, at)].lines().count();
        if !name.is_empty() && lines > FUNCTION_LINES {
            let at = source.at(line_of(&code, at));
            breaches.push(format!("{at}{name} has {lines} lines, {FUNCTION_LINES} allowed"));
        }
    }
    breaches
}

#[test]
fn files_say_what_they_are() {
    hold(&sources(&["rs"]), says_what_it_is);
}

#[test]
fn files_are_short() {
    hold(&sources(&["rs"]), short_file);
}

#[test]
fn functions_are_short() {
    hold(&sources(&["rs"]), short_functions);
}

#[test]
fn planted_sizes_are_found() {
    assert_eq!(told(says_what_it_is, "src/a.rs", "use std::io;\n").len(), 1);
    assert_eq!(told(says_what_it_is, "src/a.rs", "//!\n").len(), 1);
    assert_eq!(told(says_what_it_is, "src/a.rs", "").len(), 1);
    assert_eq!(told(says_what_it_is, "src/a.rs", "//! A room.\n"), [""; 0]);

    let long = "const A: u8 = 0;\n".repeat(FILE_LINES + 1);
    assert_eq!(told(short_file, "src/a.rs", &long), ["src/a.rs:1: 601 lines, 600 allowed"]);
    assert_eq!(told(short_file, "tests/a.rs", &long), [""; 0]);
    assert_eq!(told(short_file, "tests/a.rs", &"\n".repeat(TEST_FILE_LINES + 1)).len(), 1);
    let tests = format!("//! A room.\n#[cfg(test)]\nmod tests {{\n{long}}}\n");
    assert_eq!(told(short_file, "src/a.rs", &tests), [""; 0]);

    let body =
        |lines: usize| format!("//! A.\nfn long(x: [u8; 2]) -> [u8; 2] {{\n{}}}\n", "    g('{');\n".repeat(lines));
    assert_eq!(told(short_functions, "src/a.rs", &body(FUNCTION_LINES - 2)), [""; 0]);
    let found = told(short_functions, "src/a.rs", &body(FUNCTION_LINES - 1));
    assert_eq!(found, ["src/a.rs:2: long has 71 lines, 70 allowed"]);
    let in_macro = format!("macro_rules! m {{\n() => {{\n{}}}\n}}\n", body(100));
    assert_eq!(told(short_functions, "src/a.rs", &in_macro), [""; 0]);
    let declared = format!("trait T {{ fn a(&self);\n{}fn b(f: fn(u8) -> u8); }}\n", "\n".repeat(100));
    assert_eq!(told(short_functions, "src/a.rs", &declared), [""; 0]);
}

// Citations

/// The keys of a line, names and a year in brackets, with or without backslashes before the brackets.
fn keys(line: &str) -> Vec<String> {
    let parts = line.split('[').skip(1).filter_map(|part| part.split_once(']'));
    parts.map(|(key, _)| key.trim_end_matches('\\')).filter(|key| is_key(key)).map(str::to_owned).collect()
}

/// Names with capitals, then a year.
fn is_key(text: &str) -> bool {
    let Some((names, year)) = text.len().checked_sub(4).and_then(|at| text.split_at_checked(at)) else { return false };
    names.starts_with(|c: char| c.is_ascii_uppercase())
        && names.chars().all(|c| c.is_ascii_alphabetic())
        && year.chars().all(|c| c.is_ascii_digit())
        && (year.starts_with("19") || year.starts_with("20"))
}

/// Keys in the comments that make documentation, each with its line.
fn citations(source: &Source) -> Vec<(String, usize)> {
    let lines = source.text.lines().enumerate();
    let said = lines.filter(|(_, line)| ["//!", "///"].iter().any(|mark| line.trim_start().starts_with(mark)));
    said.flat_map(|(i, line)| keys(line).into_iter().map(move |key| (key, i + 1))).collect()
}

/// The keys of a bibliography.
fn entries(bibliography: &str) -> Vec<String> {
    let heads = bibliography.lines().filter(|line| line.starts_with('@'));
    heads.filter_map(|line| Some(line.split_once('{')?.1.trim_end_matches(',').trim().to_owned())).collect()
}

/// Rule: what is cited is in the bibliography.
fn citations_known(source: &Source, entries: &[String]) -> Vec<String> {
    let unknown = citations(source).into_iter().filter(|(key, _)| !entries.contains(key));
    unknown.map(|(key, line)| format!("{}{key} is not in refs.bib", source.at(line))).collect()
}

/// Rule: what is in the bibliography is cited.
fn entries_cited(entries: &[String], sources: &[Source]) -> Vec<String> {
    let cited: BTreeSet<String> = sources.iter().flat_map(citations).map(|(key, _)| key).collect();
    entries
        .iter()
        .filter(|key| !cited.contains(*key))
        .map(|key| format!("papers/refs.bib: nobody cites {key}"))
        .collect()
}

#[test]
fn citations_and_bibliography_agree() {
    let entries = entries(&std::fs::read_to_string(root().join("papers/refs.bib")).unwrap());
    let malformed: Vec<_> = entries.iter().filter(|key| !is_key(key)).collect();
    assert!(malformed.is_empty(), "keys are names and a year: {malformed:?}");
    let sources = sources(&["rs"]);
    hold(&sources, |source| citations_known(source, &entries));
    let breaches = entries_cited(&entries, &sources);
    assert!(breaches.is_empty(), "{}", breaches.join("\n"));
}

#[test]
fn planted_citations_are_found() {
    let entries = entries("@article{Known1999,\n  title = {A}\n}\n\n@book{KnownUncited2001,\n}\n");
    assert_eq!(entries, ["Known1999", "KnownUncited2001"]);
    let text = "//! After [Known1999], `[Guessed2003]` and \\[Third2004\\]; [`Camera`] and [x2000] are none.\nlet a = [B1999];";
    let source = Source { path: "src/a.rs".into(), text: text.into() };
    assert_eq!(
        citations_known(&source, &entries),
        ["src/a.rs:1: Guessed2003 is not in refs.bib", "src/a.rs:1: Third2004 is not in refs.bib"]
    );
    assert_eq!(entries_cited(&entries, &[source]), ["papers/refs.bib: nobody cites KnownUncited2001"]);
}

// Words

/// Rule: nothing speaks of one machine.
fn no_machine(source: &Source) -> Vec<String> {
    let found = MACHINE.iter().flat_map(|path| places(&source.text, path).map(move |at| (at, path)));
    // What goes on from a name or a slash is a part of some other path or address.
    let absolute =
        found.filter(|&(at, _)| !source.text[..at].ends_with(|c| is_name(c) || matches!(c, '/' | '.' | '-')));
    absolute
        .map(|(at, path)| format!("{}{path} is a path of one machine", source.at(line_of(&source.text, at))))
        .collect()
}

/// Rule: nothing is left to do, and nobody is told how it was made.
fn no_loose_words(source: &Source) -> Vec<String> {
    let text = source.text.to_ascii_lowercase();
    let found = WORDS.iter().flat_map(|word| places(&text, word).map(move |at| (at, word)));
    found.map(|(at, word)| format!("{}the word {word}", source.at(line_of(&text, at)))).collect()
}

/// Rule: nothing is unsafe but the lines in a list, which is [`UNSAFE`].
fn safe(source: &Source, exceptions: &[(&str, &str, &str)]) -> Vec<String> {
    let code = code(&source.text);
    let lines = places(&code, "unsafe").map(|at| line_of(&code, at));
    lines.filter(|&line| !excepted(source, line, exceptions)).map(|line| source.at(line) + "unsafe").collect()
}

#[test]
fn no_path_of_a_machine() {
    hold(&sources(&["rs", "toml", "wgsl", "md", "bib"]), no_machine);
}

#[test]
fn nothing_is_left_to_do() {
    hold(&sources(&["rs", "toml", "wgsl", "md"]), no_loose_words);
}

#[test]
fn nothing_is_unsafe() {
    hold(&sources(&["rs"]), |source| safe(source, &UNSAFE));
}

#[test]
fn planted_words_are_found() {
    for path in MACHINE {
        let text = format!("//! Room.\nlet data = \"{path}data\"; // see https://example.org{path}x\n");
        let found = told(no_machine, "src/a.rs", &text);
        assert_eq!(found, [format!("src/a.rs:2: {path} is a path of one machine")]);
    }
    for word in WORDS {
        let [upper, longer] = [format!("//! A {}, here\n", word.to_uppercase()), format!("//! A x{word}\n")];
        assert!(!told(no_loose_words, "src/a.rs", &upper).is_empty(), "{word}");
        assert_eq!(told(no_loose_words, "src/a.rs", &longer), [""; 0], "{word}");
    }
    let text = "//! Room, unsafe in words.\nlet s = \"unsafe\";\nunsafe { f() }\nunsafe_code();\n";
    let told_of = |exceptions: &[(&str, &str, &str)]| told(|source| safe(source, exceptions), "src/a.rs", text);
    assert_eq!(told_of(&[]), ["src/a.rs:3: unsafe"]);
    assert_eq!(told_of(&[("src/a.rs", "f()", "planted")]), [""; 0]);
    assert_eq!(told_of(&[("src/b.rs", "f()", "planted")]).len(), 1);
}

#[test]
fn the_whole_house_is_seen() {
    let sources = sources(&["rs"]);
    let seen = |path: &str| sources.iter().any(|source| source.path == path);
    for (folder, _) in LAYERS {
        let room = if folder == "." { "src/lib.rs".to_owned() } else { format!("{folder}/src/lib.rs") };
        assert!(seen(&room), "{room}");
    }
    assert!(seen("tests/house.rs") && sources.iter().all(|source| !source.path.starts_with("target/")));
}

#[test]
fn rust_is_read_rightly() {
    let same = "fn f<'a>(x: &'a str) -> u8 { b\u{27}x\u{27} }";
    assert_eq!(code(same), "fn f<'a>(x: &'a str) -> u8 { b    }");
    assert_eq!(
        code("a(\"x\\\"{\", '\\'', '{', '\\u{7b}'); // {\nb"),
        format!("a({:6}, {:4}, {:3}, {:8});     \nb", "", "", "", "")
    );
    assert_eq!(code("r#\"a \" {\"# + r\"\\\" /* { /* } */ */ c"), format!("{:10} + {:4} {:15} c", "", "", ""));
    assert_eq!(code("for r in \"é{\""), "for r in     ");
    let text = "struct A;\n#[cfg(test)]\nmod tests {\n    fn g() {}\n}\nfn h() {}\n";
    assert_eq!(shipped_code(text).split_whitespace().collect::<Vec<_>>(), ["struct", "A;", "fn", "h()", "{}"]);
}
