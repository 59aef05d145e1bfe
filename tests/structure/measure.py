#!/usr/bin/env python3
"""Measures the structure of stead from its source text (Python 3, standard library only).

    python3 measure.py [ROOT]                 summary and the table by crate
    python3 measure.py [ROOT] --functions     functions over 60 code lines, and over 6 parameters
    python3 measure.py [ROOT] --circles       circles of files, with the names that tie them (--calls-up: with calls up)
    python3 measure.py [ROOT] --behind        code lines compiled again after an edit in each crate
    python3 measure.py [ROOT] --walk FILE:FUNCTION [--within PREFIX]
    python3 measure.py [ROOT] --check FILE    compares with a kept table of ceilings (see the end); status 1 if one is broken
    python3 measure.py --self-test

ROOT is the checkout (default: the current folder). Counted are `crates/*/src` and `src`, without tests.

*Code line*: a line with at least one token that is neither white space nor comment nor doc comment; lines inside a string literal count.
*Test*: an item under `#[cfg(test)]`, `#[test]`, `#[cfg(any(test, ..))]`, `#[cfg(all(test, ..))]`, or a file that only such an item declares.
*Function*: a `fn` with a body; its length is the code lines from `fn` to the closing brace, closures in it included, functions nested in it
not taken out. *Parameters*: all that stand between the parentheses, `self` among them. *Destructured*: a parameter whose pattern is a tuple,
an array or a struct. *Circle*: a set of files of one crate that import each other; an import is a path that starts at `crate`, `self`, `super`
or a child module and ends at a name that another file defines, re-exports followed. What a file takes from a module that contains it does not
count, for it is a part of it; *with calls up* the functions that it takes from there do count. *Walk*: calls are followed in the order of the text, each function once, by name: functions of the file, imported ones,
`Type::function`, and methods whose name one `impl` alone defines. A *stay* is a stretch of the walk in one file; a *return* is a stay in a file
that was left before.

A text measure errs where macros make code. It is for comparing one commit with another, and no ruler for a single file.
Of commit 9653641c it counts 86 856 code lines in 787 files, 5451 functions, 43 of them over 60 lines and 32 with 7 or more parameters,
15 circles (31 with calls up).
"""
import json
import os
import re
import sys
import tempfile
from bisect import bisect_right
from collections import Counter, defaultdict

TOKEN = re.compile(
    r"""
      (?P<line>//[^\n]*)
    | (?P<block>/\*)
    | (?P<raw>\b(?:b|c)?r(?P<hashes>\#*)")
    | (?P<string>(?:\b[bc])?"(?:[^"\\]|\\.)*")
    | (?P<char>(?:\bb)?'(?:[^'\\\n]|\\(?:u\{[0-9a-fA-F_]+\}|x[0-9a-fA-F]{2}|.))')
    | (?P<life>'[A-Za-z_]\w*)
    """,
    re.X | re.S,
)


def blank(text):
    """The text with comments replaced by spaces and literals by `"` of the same length: line numbers stay."""
    out, at = [], 0
    while True:
        match = TOKEN.search(text, at)
        if not match:
            out.append(text[at:])
            return "".join(out)
        out.append(text[at : match.start()])
        kind, end = match.lastgroup, match.end()
        if match.group("block") is not None:
            depth, end = 1, match.end()
            while depth and end < len(text):
                step = re.compile(r"/\*|\*/").search(text, end)
                if not step:
                    end = len(text)
                    break
                depth += 1 if step.group() == "/*" else -1
                end = step.end()
            out.append(re.sub(r"[^\n]", " ", text[match.start() : end]))
        elif match.group("line") is not None:
            out.append(" " * (end - match.start()))
        elif match.group("raw") is not None:
            close = text.find('"' + match.group("hashes"), end)
            end = len(text) if close < 0 else close + 1 + len(match.group("hashes"))
            out.append(re.sub(r"[^\n]", '"', text[match.start() : end]))
        elif match.group("life") is not None:
            out.append(match.group())
        else:
            del kind
            out.append(re.sub(r"[^\n]", '"', match.group()))
        at = end


OPEN, CLOSE = "([{", ")]}"


def closing(text, start):
    """The place of the bracket that closes the one at `start`."""
    depth = 0
    for match in re.compile(r"[()\[\]{}]").finditer(text, start):
        depth += 1 if match.group() in OPEN else -1
        if depth == 0:
            return match.start()
    return len(text) - 1


TEST_ATTRIBUTE = re.compile(r"#\[\s*(?:cfg\s*\(\s*(?:test\b|any\s*\(\s*test\b|all\s*\(\s*test\b)|(?:\w+::)*test\s*\])")


def item_end(text, at):
    """Where the item that begins at `at` (after its attributes) ends: behind its `;` or its body."""
    depth = 0
    place = at
    for match in re.compile(r"[()\[\]{};]").finditer(text, at):
        char = match.group()
        place = match.end()
        if char == ";" and depth == 0:
            return place
        if char == "{" and depth == 0:
            end = closing(text, match.start()) + 1
            # `struct A {..}` and `mod a {..}` end here; `const A: T = B {..};` goes on to its `;`.
            head = text[at : match.start()]
            if re.match(r"\s*(pub(\([^)]*\))?\s+)?(const|static|let|type)\b(?!\s*fn)", head):
                continue_at = text.find(";", end)
                return len(text) if continue_at < 0 else continue_at + 1
            return end
        if char in "([":
            depth += 1
        elif char in ")]":
            depth -= 1
    return place


ATTRIBUTE = re.compile(r"\s*#!?\[")


def without_tests(text):
    """The blanked text without test items, and the modules that only tests declare."""
    out, at, of_tests = [], 0, []
    while True:
        match = TEST_ATTRIBUTE.search(text, at)
        if not match:
            out.append(text[at:])
            return "".join(out), of_tests
        out.append(text[at : match.start()])
        start = closing(text, text.index("[", match.start())) + 1
        while True:
            more = ATTRIBUTE.match(text, start)
            if not more:
                break
            start = closing(text, text.index("[", more.start())) + 1
        end = item_end(text, start)
        declared = re.match(r"\s*(?:pub(?:\([^)]*\))?\s+)?mod\s+(\w+)\s*;", text[start:end])
        if declared:
            of_tests.append(declared.group(1))
        out.append(re.sub(r"[^\n]", " ", text[match.start() : end]))
        at = end


class File:
    def __init__(self, root, path, crate, module):
        self.path, self.crate, self.module = path, crate, module
        with open(os.path.join(root, path), encoding="utf-8") as file:
            self.raw = file.read()
        self.all = blank(self.raw)
        self.text, self.of_tests = without_tests(self.all)
        self.starts = [0] + [m.end() for m in re.finditer("\n", self.text)]
        self.is_code = [bool(line.strip()) for line in self.text.split("\n")]
        self.code = sum(self.is_code)
        self.sums = [0]
        for flag in self.is_code:
            self.sums.append(self.sums[-1] + flag)

    def line(self, place):
        return bisect_right(self.starts, place)

    def code_between(self, start, end):
        first, last = self.line(start), self.line(end)
        return self.sums[last] - self.sums[first - 1]


def modules(root, crate, folder):
    """The files of a crate that its `lib.rs` or `main.rs` declares outside of tests."""
    found, tests = {}, []

    def visit(path, module):
        if path in found or not os.path.exists(os.path.join(root, path)):
            return
        file = found[path] = File(root, path, crate, module)
        base = os.path.dirname(path)
        name = os.path.basename(path)[:-3]
        inner = base if name in ("mod", "lib", "main") else os.path.join(base, name)
        declared = re.finditer(r"(?:#\[path\s*=\s*(\"+)\]\s*)?\bmod\s+(\w+)\s*;", file.text)
        for match in declared:
            child = match.group(2)
            if match.group(1):
                raw = re.search(r"#\[path\s*=\s*\"([^\"]*)\"", file.raw[match.start() : match.end()])
                options = [os.path.normpath(os.path.join(base, raw.group(1)))] if raw else []
            else:
                options = [os.path.join(inner, child + ".rs"), os.path.join(inner, child, "mod.rs")]
            for option in options:
                if os.path.exists(os.path.join(root, option)):
                    visit(option, module + (child,))
                    break
        for child in file.of_tests:
            tests.append((inner, child))

    for name in ("lib.rs", "main.rs"):
        visit(os.path.join(folder, name), ())
    return found


def read(root):
    crates = {}
    for name in sorted(os.listdir(os.path.join(root, "crates"))):
        if os.path.isdir(os.path.join(root, "crates", name, "src")):
            crates[name] = modules(root, name, os.path.join("crates", name, "src"))
    crates["stead"] = modules(root, "stead", "src")
    return crates


FUNCTION = re.compile(r"\bfn\s+(\w+)")


def split_list(text):
    """Splits at commas outside of brackets."""
    parts, depth, last = [], 0, 0
    previous = ""
    for place, char in enumerate(text):
        if char in "([{":
            depth += 1
        elif char in ")]}":
            depth -= 1
        elif char == "<":
            depth += 1
        elif char == ">" and previous != "-" and previous != "=":
            depth -= 1
        elif char == "," and depth == 0:
            parts.append(text[last:place])
            last = place + 1
        previous = char
    parts.append(text[last:])
    return [part.strip() for part in parts if part.strip()]


class Function:
    def __init__(self, file, name, start, parameters, body):
        self.file, self.name, self.start, self.parameters, self.body = file, name, start, parameters, body
        self.lines = file.code_between(start, body[1])
        self.owner = ""


def functions(file):
    out, text = [], file.text
    owners = []
    for match in re.finditer(r"\b(?:impl|trait)\b", text):
        brace = re.compile(r"[{;]").search(text, match.end())
        if not brace or brace.group() == ";":
            continue
        head = text[match.end() : brace.start()]
        if "(" in head and "fn" in head.split("(")[0]:
            continue
        if head.strip().startswith("<"):
            depth = 0
            for place, char in enumerate(head):
                depth += char == "<"
                depth -= char == ">" and head[place - 1] not in "-="
                if depth == 0 and char == ">":
                    head = head[place + 1 :]
                    break
        name = re.split(r"\bfor\b", head)[-1]
        name = re.search(r"(\w+)\s*(?:<|$|where|\s)", name.replace("&", " ").replace("mut ", " ").strip() + " ")
        owners.append((brace.start(), closing(text, brace.start()), name.group(1) if name else ""))
    for match in FUNCTION.finditer(text):
        place = match.end()
        while place < len(text) and text[place].isspace():
            place += 1
        if place < len(text) and text[place] == "<":
            depth = 0
            while place < len(text):
                depth += text[place] == "<"
                depth -= text[place] == ">" and text[place - 1] not in "-="
                place += 1
                if depth == 0:
                    break
            while place < len(text) and text[place].isspace():
                place += 1
        if place >= len(text) or text[place] != "(":
            continue
        end = closing(text, place)
        parameters = split_list(re.sub(r"#\[[^\]]*\]", "", text[place + 1 : end]))
        rest = re.compile(r"[{;]").search(text, end)
        # An array in the returned type, [T; 2], has a `;` of its own.
        while rest and rest.group() == ";" and text.count("[", end, rest.start()) > text.count("]", end, rest.start()):
            rest = re.compile(r"[{;]").search(text, rest.end())
        if not rest or rest.group() == ";":
            continue
        function = Function(file, match.group(1), match.start(), parameters, (rest.start(), closing(text, rest.start())))
        inside = [owner for owner in owners if owner[0] < match.start() < owner[1]]
        function.owner = inside[-1][2] if inside else ""
        out.append(function)
    return out


def destructured(parameter):
    pattern = re.split(r":(?!:)", parameter, maxsplit=1)[0].strip()
    return pattern.startswith(("(", "[", "&(", "&[")) or bool(re.match(r"&?\w[\w:]*\s*[({]", pattern))


# Imports and circles ------------------------------------------------------------------------------------------------

DEFINITION = re.compile(
    r"\b(?:struct|enum|union|trait|type|const|static|fn|macro_rules!)\s+(?:mut\s+)?(\w+)"
)


def leaves(tree, prefix=()):
    """The paths of a `use` tree: (path, name given)."""
    tree = tree.strip()
    if not tree:
        return []
    brace = tree.find("{")
    if brace >= 0:
        head = tuple(part.strip() for part in tree[:brace].split("::") if part.strip())
        inner = tree[brace + 1 : closing(tree, brace)]
        return [leaf for part in split_list(inner) for leaf in leaves(part, prefix + head)]
    match = re.match(r"(.*?)\s+as\s+(\w+)$", tree, re.S)
    path, alias = (match.group(1), match.group(2)) if match else (tree, None)
    parts = prefix + tuple(part.strip() for part in path.split("::") if part.strip())
    if parts and parts[-1] == "self":
        parts = parts[:-1]
    return [(parts, alias or (parts[-1] if parts else ""))]


class Crate:
    """The modules of a crate with what each defines and re-exports."""

    def __init__(self, files):
        self.files = {file.module: file for file in files.values()}
        self.uses, self.defines = {}, {}
        for module, file in self.files.items():
            text = re.sub(r"\bextern\s+crate\b[^;]*;", "", file.text)
            uses = []
            for match in re.finditer(r"(?P<public>\bpub(?:\([^)]*\))?\s+)?\buse\s+(?P<tree>[^;]*);", text):
                uses += [(path, alias) for path, alias in leaves(match.group("tree"))]
            self.uses[module] = uses
            self.defines[module] = set(DEFINITION.findall(text))
        self.names = {module: {alias: path for path, alias in uses if alias != "*"} for module, uses in self.uses.items()}

    def absolute(self, module, path, depth=0):
        """The path from the root of the crate; none where it leaves the crate."""
        if not path:
            return None
        head, rest = path[0], path[1:]
        if head == "crate":
            return rest
        if head == "self":
            return module + rest
        if head == "super":
            up = module[:-1]
            while rest and rest[0] == "super":
                up, rest = up[:-1], rest[1:]
            return up + rest
        if module + (head,) in self.files:
            return module + path
        known = self.names[module].get(head)
        if known is not None and known != path and depth < 8 and known[0] != head:
            base = self.absolute(module, known, depth + 1)
            return base + rest if base is not None else None
        return None

    def definer(self, path, depth=0):
        """The module that defines what a path from the root names, and its name."""
        module = ()
        for number, part in enumerate(path):
            if module + (part,) in self.files:
                module += (part,)
                continue
            name = part
            if name in self.defines[module]:
                return module, name
            known = self.names[module].get(name)
            if known is not None and depth < 8:
                target = self.absolute(module, known)
                if target is not None and tuple(target) != tuple(path[: number + 1]):
                    return self.definer(tuple(target), depth + 1)
                return None
            for other, alias in self.uses[module]:
                if alias == "*":
                    target = self.absolute(module, other[:-1])
                    if target is not None and depth < 8:
                        found = self.definer(tuple(target) + (name,), depth + 1)
                        if found:
                            return found
            return None
        return None

    def imports(self, with_calls_up=False):
        """For every file the files that it imports from, with the names; of modules that contain it the functions alone, or nothing."""
        out = defaultdict(lambda: defaultdict(set))
        paths = re.compile(r"(?<![\w:])((?:crate|self|super|[a-z_]\w*)(?:::\w+)+)")
        for module, file in self.files.items():
            wanted = [path for path, _ in self.uses[module]]
            body = re.sub(r"\buse\s+[^;]*;", "", file.text)
            wanted += [tuple(found.split("::")) for found in set(paths.findall(body))]
            for path in wanted:
                if path and path[-1] == "*":
                    continue
                target = self.absolute(module, path)
                if target is None:
                    continue
                found = self.definer(tuple(target))
                if not found or found[0] == module:
                    continue
                is_part_of = module[: len(found[0])] == found[0]
                if not is_part_of or (with_calls_up and found[1][0].islower()):
                    out[module][found[0]].add(found[1])
        return out


def components(graph):
    """Strongly connected sets of more than one node (Tarjan)."""
    index, low, stack, on, out, counter = {}, {}, [], set(), [], [0]
    sys.setrecursionlimit(10000)

    def visit(node):
        index[node] = low[node] = counter[0]
        counter[0] += 1
        stack.append(node)
        on.add(node)
        for other in graph.get(node, ()):
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in on:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            part = []
            while True:
                last = stack.pop()
                on.discard(last)
                part.append(last)
                if last == node:
                    break
            if len(part) > 1:
                out.append(sorted(part))

    for node in list(graph):
        if node not in index:
            visit(node)
    return out


def circles(crates, with_calls_up=False):
    out = []
    for name, files in crates.items():
        crate = Crate(files)
        imports = crate.imports(with_calls_up)
        for part in components({module: set(to) for module, to in imports.items()}):
            ties = [
                (crate.files[a].path, crate.files[b].path, sorted(imports[a][b]))
                for a in part
                for b in part
                if b in imports.get(a, {})
            ]
            out.append((name, [crate.files[module].path for module in part], ties))
    return out


# The walk -----------------------------------------------------------------------------------------------------------

CALL = re.compile(r"(?<![\w!])(?P<path>(?:\w+::)*)(?P<turbo>)(?P<name>[a-z_]\w*)\s*(?:::<[^()]*?>)?\s*\(|\.(?P<method>[a-z_]\w*)\s*(?:::<[^()]*?>)?\s*\(")
# A function that is handed on by name, as in `map(Self::cost)`.
NAMES_OF_STD = set(
    "new from into iter map and_then collect clone len push extend get insert unwrap_or min max abs sum fold filter any all zip default fmt eq"
    " cmp partial_cmp next as_ref as_deref with_capacity contains is_empty first last sort_by take skip copied cloned find position of ok err"
    " join then then_some values keys entry read write min_by max_by windows chunks rev norm dot cross transpose is_some is_none".split()
)


def walk(crates, start, within):
    """The stays of the walk from FILE:FUNCTION through functions of files whose path begins with `within`."""
    path, name = start.split(":")
    every = {}
    by_file, by_method, by_owner, free = defaultdict(dict), defaultdict(list), defaultdict(list), defaultdict(list)
    known = {}
    for crate_name, files in crates.items():
        crate = known[crate_name] = Crate(files)
        for file in files.values():
            for function in functions(file):
                every[(file.path, function.start)] = function
                by_file[file.path].setdefault(function.name, function)
                if function.owner:
                    by_method[function.name].append(function)
                    by_owner[(function.owner, function.name)].append(function)
                else:
                    free[function.name].append(function)
    stays, done, count = [], set(), [0]

    def stay(file):
        if not stays or stays[-1] != file:
            stays.append(file)

    def resolve(function, match):
        crate = known[function.file.crate]
        method = match.group("method")
        if method:
            if method in NAMES_OF_STD:
                return None
            options = by_method.get(method, [])
            own = [option for option in options if option.file.path == function.file.path]
            options = own or options
            return options[0] if len(options) == 1 else None
        called, prefix = match.group("name"), tuple(part for part in match.group("path").split("::") if part)
        if prefix and prefix[-1] == "Self":
            options = [option for option in by_owner.get((function.owner, called), [])]
            return options[0] if len(options) >= 1 else None
        if prefix and prefix[-1][0].isupper():
            options = by_owner.get((prefix[-1], called), [])
            near = [option for option in options if option.file.crate == function.file.crate]
            options = near if len(near) == 1 else options
            return options[0] if len(options) == 1 else None
        if not prefix:
            here = by_file[function.file.path].get(called)
            if here and not here.owner:
                return here
        module = function.file.module
        route = prefix + (called,)
        target = crate.absolute(module, route)
        if target is None and route[0] in crate.names[module]:
            route = crate.names[module][route[0]] + route[1:]
            target = crate.absolute(module, route)
        if target is not None:
            found = crate.definer(tuple(target))
            if found:
                return by_file[crate.files[found[0]].path].get(found[1])
            return None
        if route[0].startswith("stead_"):
            other = known.get(route[0][len("stead_") :].replace("_", "-"))
            if other:
                found = other.definer(tuple(route[1:]))
                if found:
                    return by_file[other.files[found[0]].path].get(found[1])
        return None

    def visit(function):
        key = (function.file.path, function.start)
        stay(function.file.path)
        if key in done:
            return
        done.add(key)
        count[0] += 1
        body = function.file.text[function.body[0] : function.body[1]]
        for match in CALL.finditer(body):
            other = resolve(function, match)
            if other is None or other is function or not other.file.path.startswith(within):
                continue
            if (other.file.path, other.start) in done:
                continue
            visit(other)
            stay(function.file.path)

    begin = by_file.get(path, {}).get(name)
    if begin is None:
        sys.exit(f"no function {name} in {path}")
    sys.setrecursionlimit(100000)
    visit(begin)
    files = set(stays)
    return {"stays": len(stays), "files": len(files), "returns": len(stays) - len(files), "functions": count[0]}, stays


# Crates -------------------------------------------------------------------------------------------------------------


def dependencies(root):
    out = {}
    for name in sorted(os.listdir(os.path.join(root, "crates"))) + [""]:
        path = os.path.join(root, "crates", name, "Cargo.toml") if name else os.path.join(root, "Cargo.toml")
        if not os.path.exists(path):
            continue
        needed, section = set(), ""
        for line in open(path, encoding="utf-8"):
            if line.startswith("["):
                section = line.strip()
            match = re.match(r"stead-([\w-]+)[\s.=]", line)
            if match and section == "[dependencies]":
                needed.add(match.group(1))
        out[name or "stead"] = needed
    return out


def behind(root, code):
    """For each crate the code lines of itself and of all that need it."""
    needs = dependencies(root)
    out = {}
    for name in code:
        found, more = {name}, [name]
        while more:
            now = more.pop()
            for other, of in needs.items():
                if now in of and other not in found:
                    found.add(other)
                    more.append(other)
        out[name] = (sum(code.get(other, 0) for other in found), len(found))
    return out


def measure(root):
    crates = read(root)
    rows, all_functions = {}, []
    for name, files in crates.items():
        own = [function for file in files.values() for function in functions(file)]
        all_functions += own
        docs = sum(
            1
            for file in files.values()
            for line, blanked in zip(file.raw.split("\n"), file.all.split("\n"))
            if line.lstrip().startswith(("///", "//!")) and not blanked.strip()
        )
        rows[name] = {"code": sum(file.code for file in files.values()), "doc": docs, "files": len(files), "functions": len(own)}
    lengths = sorted(function.lines for function in all_functions)
    counts = [len(function.parameters) for function in all_functions]
    every = [file for files in crates.values() for file in files.values()]
    defined = Counter()
    for file in every:
        for name in re.findall(r"\b(?:struct|enum|trait|union|type)\s+([A-Z]\w*)", file.text):
            defined[name] += 1
    found = circles(crates)
    heads = sum(len(re.findall(r"(?m)^\s*//[/!] What ", file.raw)) for file in every)
    summary = {
        "code": sum(row["code"] for row in rows.values()),
        "files": sum(row["files"] for row in rows.values()),
        "files_over_400": sum(file.code > 400 for file in every),
        "functions": len(lengths),
        "functions_over_60": sum(length > 60 for length in lengths),
        "functions_over_45": sum(length > 45 for length in lengths),
        "longest_function": lengths[-1],
        "parameters_7_or_more": sum(count >= 7 for count in counts),
        "parameters_6_or_more": sum(count >= 6 for count in counts),
        "parameters_destructured": sum(destructured(p) for function in all_functions for p in function.parameters),
        "circles": len(found),
        "files_in_circles": sum(len(files) for _, files, _ in found),
        "circles_with_calls_up": len(circles(crates, True)),
        "type_names_twice": sum(count > 1 for count in defined.values()),
        "type_names_3_times": sum(count > 2 for count in defined.values()),
        "json_macros": sum(len(re.findall(r"\bjson!\s*[({\[]", file.text)) for file in every),
        "lines_over_120": sum(len(line) > 120 for file in every for line in file.raw.split("\n")),
        "heads_that_begin_with_what": heads,
    }
    return crates, rows, summary, all_functions, found


def self_test():
    text = 'fn a(x: u8, (y, z): (u8, [u8; 2]), f: impl Fn(u8, u8) -> u8) -> [u8; 2] {\n // no\n let s = "}//";\n let c = \'"\';\n s\n}\n'
    text += "/* a /* nested */ } */\n#[cfg(test)]\nmod tests {\n fn b() {}\n}\n/// What a doc.\nfn c<'a, T: Fn(u8) -> u8>(&'a self) {}\n"

    class Fake(File):
        def __init__(self, raw):
            self.path, self.crate, self.module, self.raw = "a.rs", "a", (), raw
            self.all = blank(raw)
            self.text, self.of_tests = without_tests(self.all)
            self.starts = [0] + [m.end() for m in re.finditer("\n", self.text)]
            self.is_code = [bool(line.strip()) for line in self.text.split("\n")]
            self.sums = [0]
            for flag in self.is_code:
                self.sums.append(self.sums[-1] + flag)
            self.code = sum(self.is_code)

    file = Fake(text)
    found = functions(file)
    assert [f.name for f in found] == ["a", "c"], found
    assert [len(f.parameters) for f in found] == [3, 1], [f.parameters for f in found]
    assert found[0].lines == 5 and file.code == 6, (found[0].lines, file.code)
    assert [destructured(p) for p in found[0].parameters] == [False, True, False]
    assert leaves("a::{b, c::{self, d as e}, f::*}") == [
        (("a", "b"), "b"), (("a", "c"), "c"), (("a", "c", "d"), "e"), (("a", "f", "*"), "*")], leaves("a::{b, c::{self, d as e}, f::*}")
    assert components({1: {2}, 2: {1}, 3: {1}}) == [[1, 2]]
    texts = {
        "lib.rs": "mod a;\nmod b;\npub use b::Shown;\npub fn top() { a::first(); b::last() }\n#[cfg(test)]\nmod tests;\n",
        "a.rs": "use crate::Shown;\nmod inner;\npub(crate) struct Own(Shown);\npub(crate) fn first() { inner::deep() }\nfn helped() {}\n",
        "a/inner.rs": "use super::{Own, helped};\npub(super) fn deep() { helped() }\n",
        "b.rs": "pub struct Shown;\npub(crate) fn last() { let _: Option<crate::a::Own> = None; }\n",
        "tests.rs": "fn not_counted() {}\n",
    }
    with tempfile.TemporaryDirectory() as root:
        for name, raw in texts.items():
            path = os.path.join(root, "crates", "x", "src", name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "w", encoding="utf-8") as out:
                out.write(raw)
        crates = {"x": modules(root, "x", "crates/x/src")}
        assert len(crates["x"]) == 4, crates
        assert [len(files) for _, files, _ in circles(crates)] == [2], circles(crates)
        assert [len(files) for _, files, _ in circles(crates, True)] == [3], circles(crates, True)
        counted, stays = walk(crates, "crates/x/src/lib.rs:top", "crates/")
        names = [os.path.basename(stay) for stay in stays]
        assert names == ["lib.rs", "a.rs", "inner.rs", "a.rs", "inner.rs", "a.rs", "lib.rs", "b.rs", "lib.rs"], names
        assert counted["functions"] == 5 and counted["returns"] == 5, counted
    print("self-test: ok")


def main():
    arguments = sys.argv[1:]
    if "--self-test" in arguments:
        return self_test()
    option = {}
    for name in ("--walk", "--within", "--check"):
        if name in arguments:
            place = arguments.index(name)
            option[name] = arguments[place + 1]
            del arguments[place : place + 2]
    flags = {argument for argument in arguments if argument.startswith("--")}
    places = [argument for argument in arguments if not argument.startswith("--")]
    root = places[0] if places else "."
    if "--walk" in option:
        crates = read(root)
        start = option["--walk"]
        within = option.get("--within", os.path.dirname(start.split(":")[0]))
        found, stays = walk(crates, start, within)
        print(json.dumps({"walk": start, "within": within, **found}))
        if "--stays" in flags:
            print("\n".join(stays))
        return None
    crates, rows, summary, all_functions, found = measure(root)
    if "--check" in option:
        with open(option["--check"], encoding="utf-8") as file:
            ceilings = json.load(file)
        broken = [f"{key}: {summary[key]}, at most {most}" for key, most in ceilings.items() if summary.get(key, 0) > most]
        print("\n".join(broken) or "no ceiling is broken")
        sys.exit(1 if broken else 0)
    if "--functions" in flags:
        for function in sorted(all_functions, key=lambda f: -f.lines):
            if function.lines > 60:
                print(f"{function.lines:4} lines  {function.file.path}:{function.file.line(function.start)} {function.name}")
        for function in sorted(all_functions, key=lambda f: -len(f.parameters)):
            if len(function.parameters) >= 7:
                print(f"{len(function.parameters):4} parameters  {function.file.path}:{function.file.line(function.start)} {function.name}")
        return None
    if "--circles" in flags:
        for number, (crate, files, ties) in enumerate(circles(crates, "--calls-up" in flags), 1):
            print(f"circle {number} of {crate}: {', '.join(files)}")
            for a, b, names in ties:
                print(f"    {a} -> {b}: {', '.join(names)}")
        return None
    code = {name: row["code"] for name, row in rows.items()}
    if "--behind" in flags:
        for name, (lines, count) in sorted(behind(root, code).items(), key=lambda item: -item[1][0]):
            print(f"{name:12} {lines:6} lines in {count} crates are compiled again after an edit here")
        return None
    for name, row in sorted(rows.items(), key=lambda item: -item[1]["code"]):
        print(f"{row['code']:7} code {row['doc']:6} doc {row['files']:4} files {row['functions']:5} functions  {name}")
    print(json.dumps(summary, indent=1))
    return None


if __name__ == "__main__":
    try:
        main()
    except BrokenPipeError:
        sys.stderr.close()
