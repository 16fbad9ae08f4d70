#!/usr/bin/env python3
"""Find phrases that make the project's English read like a translation.

    lint.py [ROOT] [--only NAME[,NAME]] [--kinds rs,md,other,git,id] [--counts] [--sample N [--seed S]] [--git-since REV]
            [--max TOTAL | --ceiling FILE]

Reads comments, doc comments and strings of .rs files, .md files, with `--kinds other` the comments of scripts, device
clients and settings files, commit subjects (git log) and, with `--kinds id`, the names of modules and types. Files that git ignores are skipped. Prints `path:line: [pattern] "match" -> suggestion`,
then a count per pattern. Exit status 1 when there are more hits than `--max`, or than the number in the file
`--ceiling`, or when that number is higher than in the last commit (default: never fails). Python 3.8, standard library
only.

A hit is a suspicion, not an error: silence a line with `lint: ok` in it, or `<!-- lint: ok -->` in Markdown.
"""
import argparse
import collections
import os
import random
import re
import subprocess
import sys

SKIP = {"target", ".git", "node_modules", "snapshots", "fonts"}
# Inanimate subjects that "know", "want" or "hear" something here.
THING = (r"(?:crates?|loops?|drivers?|panels?|modules?|files?|rigs?|links?|programs?|threads?|tables?|machines?|consoles?|"
         r"screens?|gates?|emulators?|devices?|handles?|recorders?|lines?|wizards?|readers?|networks?|sessions?|windows?|"
         r"recordings?|ends?|core|codec|governor|supervisor|bridge|journal)")

# name, regex, suggestion, kinds it applies to: c comment, d doc comment, s string, m Markdown, g commit subject
P = []


def pattern(name, regex, advice, kinds="cdsmg", flags=re.I):
    P.append((name, re.compile(regex, flags), advice, set(kinds)))


# Verbs and phrases -----------------------------------------------------------------------------------------------------
pattern("tell",
        r"\b(?:is|are|was|were|be|been|being|and|or|it|which|that|this|what|who|nothing|also) told\b(?! otherwise)"
        r"|\btells?\b(?! (?:apart|you|me|us))(?!.{0,25}\b(?:apart|from each other)\b)",
        "report, show, say, indicate, warn, return (and name who reports)")
pattern("stands",
        r"\bstands? (?:in|at|on|behind|before|beside|above|below|over|under|with|between|there|out|first|last|where|until)\b",
        "is, is stored in, appears in, is shown at")
pattern("made-of", r"\bmade (?:of|anew)\b", "computed from, built from, derived from; rebuilt")
pattern("in-place-of", r"\bin place of\b", "instead of")
pattern("anew", r"\banew\b|\bbegun again\b", "again; restart, re-measure, redraw, retrain")
pattern("goes-on", r"\b(?:go|goes|going|went) on\b(?! (?:strike|for ever))", "continue, keep running, resume, proceed")
pattern("in-force", r"\b(?:in|into|out of) force\b(?! space)", "active, applied, current, in use; to activate")
# Not the noun: "two hands on a ring", "changes hands in mid-air".
pattern("hand-over",
        r"(?:(?<!two )(?<!the )(?<!both )(?<!changes )(?<!brakes )(?<!^)\bhands(?! in phase)|\bhanded) (?:over|in|on)\b"
        r"|\bhand (?:it|them|this) (?:over|on)\b",
        "pass, forward, deliver; (time) is passed in as an argument")
pattern("take-verb",
        r"\btake[sn]? (?:it|them|this|that|what|a \w+|the \w+)? ?for (?:a|an|the|one|that|nothing)\b|\btook .{1,20} for\b"
        r"|\bpass(?:es|ed)? over\b|\btakes? back\b|\btaken back\b|\bput(?:s)? away\b",
        "mistake for, treat as; skip, ignore; undo; discard")
pattern("asked", r"\b(?:is|are|was|were|be|been) asked(?: for| of)?\b", "requested, required, commanded, queried")
pattern("look-whether",
        r"\blook(?:s|ed|ing)? (?:at )?(?:whether|if)\b|\b(?:is|are|was|were|be) looked (?:at|for|whether)\b",
        "check whether; inspect, examine, search for")
pattern("happening", r"\bhappenings?\b|\bwhat happened to\b", "event; events of, changes to")
pattern("comes", r"\bwhat (?:comes|came|has come|goes)\b|\b(?:comes|came) (?:with|by|of|to be)\b|\bas (?:it|they) c[oa]mes?\b",
        "what arrives/arrived, received data, incoming; is included; unmodified")
pattern("become", r"\b(?:has|have|had) become\b|\bwhat becomes of\b|\bbecame of\b|^Join what\b",
        "name the result; a merge subject names the branch and its content")
pattern("beside", r"\bbesides?\b(?! (?:it\b|each other|the (?:trocar|wire|stop|button|shaft|tissue|file|3-D)))",
        "next to, alongside, in addition to, compared with, while ... is running")
pattern("as-it-is", r"\bas (?:it|they) (?:is|are|was|were)(?: (?:now|then|before|recorded|wanted|written|asked|sent|given))?(?=\s*(?:[.,;:)]|$))",
        "unchanged, verbatim, as recorded, the current X")
pattern("exchanged", r"\bexchanged\b(?! (?:with each|in each))|\bexchanges? (?:right|left|the two|two|them|it)\b",
        "swap, swapped, replace")
pattern("share-of", r"\b(?:a|the|this|that|which|what|its|their|by this|small|such a) share\b|\bshare of (?:the|a|its|all|this)\b",
        "fraction, proportion, ratio, percentage")
pattern("old-words",
        r"\b(?:mend(?:s|ed)?|cures?|cured|dearer?|foretold|foretells?|lest|thereof|whereof|forerunner|astray|unasked|aught|"
        r"therein|needless|whence|hitherto|seldom)\b",
        "fix, remedy/what to do, slower/more expensive, predicted, rarely, unexpectedly ...")
pattern("of-its-own", r"\bof (?:its|their|our|his|your|my|one's) own\b", "its own X (a thread of its own -> its own thread)")
# Pronouns and persons --------------------------------------------------------------------------------------------------
pattern("nobody", r"\b(?:nobody|somebody|anybody|everybody)(?:'s)?\b",
        "name the role (user, client, operator, other process) or use the passive")
pattern("whoever", r"\bwhomever\b|\bwhoever\b|(?:^|[.;:(] )[Ww]ho (?:[a-z]+s|has|is|can|may)\b(?![^.;]*\?)",
        "anyone who, a user/client/reader who; regardless of")
pattern("personified",
        r"\b" + THING + r" (?:alone )?(?:knows?|knew|learns?|learnt|sees?|hears?|heard|wants?|believes?|thinks?|obeys?|minds?|promises?|"
        r"trusts?|hopes?|likes|feels?|forgets?)\b",
        "has, receives, stores, requires, supports, detects; is rejected/reported", "cdmg")
# Sentence shapes -------------------------------------------------------------------------------------------------------
pattern("what-clause",
        r"^(?:[-*] |\d+\. )?(?:\*\*)?What (?!if\b|is .*\?|are .*\?|it (?:is|does)\b|(?:the|a|an|each|every) \w+ (?:does|means|needs)\b)[^?|]*$"
        r"|(?:[,;:] |\bof |\bby |\bfrom |\bwith |\bto )what (?:is|are|was|were|has|have|had|it|they|the|a|an|this|that|"
        r"nobody|others?|these|each|only|follows|lies|passes?|else|remains|lasts|waits|crosses|must|can|may|does)\b(?![^.]*\?)",
        "use a noun: the data, the value, the remainder, the settings, output, state", "cdmg")
pattern("of-fragment",
        r"^(?:\*\*)?Of (?:a|an|the|this|that|these|those|all|every|each|one|two|its|both|any|several|either|now|rounding)\b"
        r"|(?:[.;] )Of (?:a|an|the|this|these|those|all|every|each|one|two|its|both|any|several)\b[^,.]{2,60},? (?:\w+ )?",
        "start with the subject: \"One of the two arms ...\"; give the noun that the fragment belongs to", "cdmg", 0)
pattern("fragment-reason", r"^(?:So that|Because|Without (?:it|them|this|that)|Else|Also|Where|As) [^,]{3,80}\.$",
        "write the main clause: \"Needed so that ...\", \"Keeps ...\"", "c", 0)
pattern("relative-prep",
        r", (?:of|by|from|under|after) (?:which|whom|whose)\b|\bthat (?:is|are|was|were) (?:to be|his|theirs|ours)\b",
        "split into two sentences, or put the noun first", "cdsmg")
pattern("is-no", r"(?<!there )(?<!here )\b(?:is|are|was|were) no (?!longer|more\b|different|doubt|reason|need|way|such|other\b|less|worse|better|one\b|match)\w+",
        "is not a ...; rejected as ..., invalid", "cdsmg")
pattern("that-of", r"\b(?:is|are|was|were) (?:that|those) of\b",
        "repeat the noun, or use a possessive (the arm's, the file's)", "cdmg")
pattern("most-least",
        r"^(?:Most|Least|Greatest) (?!of\b|importantly|likely|squares\b|one\b)[a-z]+|\b(?:the|and) (?:most|least) that\b|, (?:most|least) first\b"
        r"|\b(?:for|of|by|every|to|has|have|after|than|one in) so (?:many|much|long)\b(?! (?:as|that|more|the))",
        "maximum number of, minimum, upper limit; this many / this long", "cdsm")
pattern("there-is", r"\b(?:is|are|was|were) (?:not )?there\b(?! (?:is|are|was|were|no|a|an|any)\b)|\bwhat is (?:not )?there\b",
        "exists, is present, is available; missing, not found", "cdsmg")
# Private vocabulary ----------------------------------------------------------------------------------------------------
pattern("picture", r"\b(?:endoscope's|camera's|surgeon's) pictures?\b|\bpictures (?:a|per) second\b|\bpicture(?:'s)? (?:moment|rate|age)\b|"
                   r"\b(?:newest|next|each|every|last|first) picture\b",
        "image, frame, video (frames per second)", "cdsmg")
pattern("words", r"\bin words\b|\bwords (?:of|for|over|on|that|are|stand)\b|\b(?:its|their|these|those|the|weak) words\b",
        "text, message, wording, label", "cdsmg")
pattern("private-noun",
        r"\b(?:in the past\b|the past (?:on|shows|is|has)\b|way of the (?:data|hand|tip)\b|a hole in|holes? in (?:the|a) (?:journal|file|session)\b|"
        r"walked (?:on|in|by|as)\b|is walked\b|parcels?\b|second place\b|which door\b|bites?\b(?= within))",
        "playback/recorded session, path, gap, results, tested end to end, emergency release, packet, protocol, measurements, backup file",
        "cdsmg")
# Commit subjects -------------------------------------------------------------------------------------------------------
pattern("subject-not-imperative",
        r"^(?:An? |The |What |Of |One |Two |Three |Where |Who |Every |All |Without |In |On |How |Whether |Which |When |Why |"
        r"Tests? |Figures |Words |It |Its |Both |Only |Nothing |Some |Each |\S+'s )",
        "imperative verb first: Add, Fix, Refuse, Measure, Rename, Merge", "g", 0)
pattern("subject-too-long", r"^.{73,}$", "at most 72 characters; details go into the body", "g", 0)
pattern("subject-merge", r"^(?:Join|Merge) (?:what|the (?:newest|last|main))\b", "Merge branch 'NAME': what it adds", "g", 0)

# Identifiers -----------------------------------------------------------------------------------------------------------
BAD_MODULES = {
    "told": "report, feedback", "known": "device_identity", "kept": "retention, history", "held": "handle_input",
    "eyes": "endoscope_view", "past": "playback", "film": "session_reader", "door": "loop_channel", "desk": "layout, input_devices",
    "shelf": "session_store", "scribe": "journal_writer", "taking": "receive", "leaving": "shutdown", "outlet": "session_sink",
    "obstacle": "engage_blocker", "scored": "trial_score", "copied": "remote_copy", "watched": "remote_view", "plotted": "plot_channels",
    "cut": "trim", "reel": "picture_queue", "workshop": "render_thread", "shot": "render", "clerk": "handshake_thread",
    "hearing": "receive", "holding": "control_owner", "keeping": "session_upkeep", "aside": "side_panel", "rest": "break_page",
    "cloud": "force_cloud", "diary": "test_log", "seen": "visible_state", "acting": "dispatch", "reaching": "availability",
    "reviewing": "playback_mode", "written": "labels", "lead": "mouse_drive", "telling": "stderr, unblinding_risk", "truth": "ground_truth",
    "motion": "recording_input", "ending": "run_outcome", "stretch": "time_range", "shells": "completions", "setup": "rig_args",
    "seeking": "device_search", "own": "own_side_check", "acts": "task_input", "flawed": "noise_model", "alone": "standalone",
    "places": "addresses", "carrying": "ring_task", "threading": "wire_task", "searching": "palpation_task", "feeling": "force_response",
    "playing": "training_task", "person": "simulated_person", "leap": "jump_detector", "flight": "runaway_detector", "pace": "time_scale",
    "widest": "simd", "beside": "compare", "lens": "camera_calibration", "plate": "banner", "halves": "stereo", "unread": "stream_buffer",
    "waiting": "frame_queue", "judge": "frame_health", "bulletin": "peer_status", "objections": "refusals", "far": "remote_follower",
    "tap": "loop_recorder_tap", "happenings": "events", "wants": "subscriptions", "outlook": "disk_forecast", "hidden": "occlusion",
}
BAD_TYPES = {
    "Told", "Kept", "Known", "Held", "Wish", "Way", "Wrong", "Desk", "Shelf", "Scribe", "Outlet", "Film", "Teller", "Easel", "Studio",
    "Photographer", "Album", "Reel", "Workshop", "Clerk", "Meddler", "Witness", "Door", "LineDoor", "WristDoor", "News", "Diary", "Eyes",
    "Glimpse", "Glance", "Bulletin", "Obstacle", "Trouble", "Cloud", "Leap", "Flight", "Flown", "Rest", "Calm", "Keeper", "Aside", "Beside",
    "Past", "Rescue", "Mail", "Parcel", "Act", "Sought", "Came", "Met", "Many", "With", "Of", "In", "At", "One", "Why", "Over", "Far", "Fate",
    "Hoop", "Hole", "Stance", "Outlook", "Playing", "Feeling", "Searching", "Sheet", "Heard", "Seen", "Asked", "About", "Taken", "Found",
    "Standing", "Bench", "Ran", "Says", "Shows", "Speaks", "Doing", "Which", "Gone", "Before", "Beyond", "Now", "Next",
}


def lex(source):
    """Yields (kind, line, text) for comments (c), doc comments (d) and strings (s) of Rust source."""
    i, n, line = 0, len(source), 1
    while i < n:
        ch = source[i]
        if ch == "\n":
            line += 1
            i += 1
        elif source.startswith("//", i):
            j = source.find("\n", i)
            j = n if j < 0 else j
            text = source[i:j]
            yield ("d" if text.startswith(("///", "//!")) else "c"), line, re.sub(r"^//[/!]?\s?", "", text)
            i = j
        elif source.startswith("/*", i):
            j = source.find("*/", i)
            j = n if j < 0 else j + 2
            yield "c", line, source[i:j]
            line += source.count("\n", i, j)
            i = j
        else:
            raw = re.match(r'(?:br|r|cr)(#*)"', source[i:i + 12])
            if raw and (i == 0 or not (source[i - 1].isalnum() or source[i - 1] == "_")):
                end = '"' + raw.group(1)
                j = source.find(end, i + raw.end())
                j = n if j < 0 else j + len(end)
                line += source.count("\n", i, j)
                i = j
            elif ch == '"':
                j = i + 1
                while j < n and source[j] != '"':
                    j += 2 if source[j] == "\\" else 1
                text = re.sub(r"\\\n\s*", "", source[i + 1:j])
                if len(re.findall(r"[A-Za-z]{2,}", text)) >= 3 and " " in text:
                    yield "s", line, text
                line += source.count("\n", i, j + 1)
                i = j + 1
            elif ch == "'":
                m = re.match(r"'(\\.[^']*|[^'\\\n])'", source[i:i + 14])
                i += m.end() if m else 1
            else:
                i += 1


def git(root, *arguments):
    """Standard output of a git command in this folder; None if it fails, also where git is missing."""
    try:
        done = subprocess.run(["git", "-C", root, *arguments], capture_output=True, text=True, encoding="utf8")
    except OSError:
        return None
    return done.stdout if done.returncode == 0 else None


def walk(root, ends):
    if os.path.isfile(root):
        if root.endswith(ends):
            yield root
        return
    listed = git(root, "ls-files", "-z", "--cached", "--others", "--exclude-standard")
    if listed is not None:
        for name in sorted(set(listed.split("\0"))):
            path = os.path.join(root, name)
            if name.endswith(ends) and not SKIP.intersection(name.split("/")) and os.path.isfile(path):
                yield path
        return
    for folder, folders, files in os.walk(root):
        folders[:] = sorted(f for f in folders if f not in SKIP)
        for name in sorted(files):
            if name.endswith(ends):
                yield os.path.join(folder, name)


def place(path, root):
    return path if os.path.isfile(root) else os.path.relpath(path, root)


def comments(path, name):
    """(kind, place, text) of the comments, descriptions and docstrings of a file that is neither Rust nor Markdown."""
    mark = r"(?:^|\s)(?://|/?\*+) ?(.*)" if path.endswith((".c", ".h")) else r"(?:^|\s)# ?(.*)"
    quoted = False
    with open(path, encoding="utf8", errors="replace") as file:
        for number, line in enumerate(file, 1):
            found = re.search(mark, line) or re.match(r'description = "(.*)"', line)
            if path.endswith(".py") and (quoted or '"""' in line):
                yield "c", f"{name}:{number}", line.strip().strip('"')
            elif found:
                yield "c", f"{name}:{number}", found.group(1)
            quoted ^= line.count('"""') % 2 == 1


def units(root, kinds, since):
    """(kind, place, text): one physical line of prose each."""
    if "rs" in kinds:
        for path in walk(root, ".rs"):
            example = False
            with open(path, encoding="utf8", errors="replace") as file:
                for kind, line, text in lex(file.read()):
                    # Skip the code of examples in doc comments.
                    example = kind == "d" and example != text.startswith("```")
                    if example:
                        continue
                    yield kind, f"{place(path, root)}:{line}", text
    if "other" in kinds:
        for path in walk(root, (".toml", ".py", ".c", ".h", ".sh", ".R", ".rules", "dev", "ci/run")):
            if os.path.abspath(path) != os.path.abspath(__file__):
                yield from comments(path, place(path, root))
    if "md" in kinds:
        for path in walk(root, ".md"):
            code = False
            with open(path, encoding="utf8", errors="replace") as file:
                for number, text in enumerate(file, 1):
                    if text.startswith("```"):
                        code = not code
                    elif not code:
                        yield "m", f"{place(path, root)}:{number}", text.rstrip("\n")
    if "git" in kinds and not os.path.isfile(root):
        rows = git(root, "log", "--format=%h\t%s", "HEAD", *(f"^{start}" for start in since))
        if rows is None:
            sys.exit(f"git log fails in {root}, or one of these revisions is missing: {' '.join(since)}")
        for row in rows.splitlines():
            short, _, subject = row.partition("\t")
            yield "g", f"commit {short}", subject


def prose(text):
    """Without code and addresses, which keep their width so that `match` positions stay readable."""
    return re.sub(r"`[^`]*`|\]\([^)]*\)|https?://\S+|\{[^}]*\}", lambda m: " " + "x" * max(0, len(m.group()) - 2) + " ", text)


def identifiers(root):
    for path in walk(root, ".rs"):
        rel = place(path, root)
        stem = os.path.basename(os.path.dirname(path)) if path.endswith("/mod.rs") else os.path.basename(path)[:-3]
        if stem in BAD_MODULES:
            yield rel + ":1", "module-name", stem, BAD_MODULES[stem]
        with open(path, encoding="utf8", errors="replace") as file:
            for number, text in enumerate(file, 1):
                found = re.match(r"\s*(?:pub(?:\([^)]*\))? )?(?:struct|enum|trait|type) ([A-Z]\w*)", text)
                if found and found.group(1) in BAD_TYPES:
                    yield f"{rel}:{number}", "type-name", found.group(1), "a noun that says what it holds"


def read_ceiling(path):
    """The number in this file; exits if it is higher than in the last commit or in one of that commit's parents."""
    with open(path, encoding="utf8") as file:
        ceiling = int(file.read())
    folder, name = os.path.split(os.path.abspath(path))
    for revision in (git(folder, "rev-list", "--parents", "-n1", "HEAD") or "").split():
        before = git(folder, "show", f"{revision}:./{name}")
        if before is not None and int(before) < ceiling:
            sys.exit(f"{path} is {ceiling}, in commit {revision[:8]} {int(before)}: the ceiling may only fall")
    return ceiling


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", nargs="?", default=".")
    parser.add_argument("--only", default="")
    parser.add_argument("--kinds", default="rs,md,git")
    parser.add_argument("--counts", action="store_true", help="print the counts only")
    parser.add_argument("--sample", type=int, default=0, help="print a random sample of hits instead of all")
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--git-since", action="append", default=[], help="only commits after this revision (repeatable)")
    parser.add_argument("--max", type=int, default=-1, help="fail when there are more hits than this")
    parser.add_argument("--ceiling", default="", help="file with the maximum number of hits, which may only fall")
    a = parser.parse_args()
    ceiling = read_ceiling(a.ceiling) if a.ceiling else a.max
    kinds, only = set(a.kinds.split(",")), {x for x in a.only.split(",") if x}
    hits = []
    for kind, place, text in units(a.root, kinds, a.git_since):
        if "lint: ok" in text:
            continue
        clean = prose(text)
        for name, regex, advice, where in P:
            if kind in where and (not only or name in only):
                found = regex.search(clean)
                if found:
                    hits.append((place, name, text[max(0, found.start() - 45):found.end() + 45].strip(), advice, kind))
    if "id" in kinds:
        hits += [(place, name, word, advice, "i") for place, name, word, advice in identifiers(a.root)]
    if not a.counts:
        shown = random.Random(a.seed).sample(hits, min(a.sample, len(hits))) if a.sample else hits
        for place, name, text, advice, _ in shown:
            print(f'{place}: [{name}] "{text}" -> {advice}')
    table = collections.Counter((name, kind) for _, name, _, _, kind in hits)
    names = sorted({name for name, _ in table}, key=lambda name: -sum(table[name, k] for k in "cdsmgi"))
    print(f"\n{'pattern':24}{'all':>7}{'comment':>9}{'rustdoc':>9}{'string':>8}{'md':>7}{'commit':>8}{'name':>6}", file=sys.stderr)
    for name in names:
        row = [table[name, k] for k in "cdsmgi"]
        print(f"{name:24}{sum(row):7}{row[0]:9}{row[1]:9}{row[2]:8}{row[3]:7}{row[4]:8}{row[5]:6}", file=sys.stderr)
    total = len(hits)
    print(f"{'total':24}{total:7}", file=sys.stderr)
    if 0 <= ceiling < total:
        sys.exit(f"{total} hits, at most {ceiling} allowed: rewrite the new ones (CONTRIBUTING.md, \"English\")")
    if a.ceiling and total < ceiling:
        print(f"{total} hits, fewer than the ceiling {ceiling}: write {total} into {a.ceiling}", file=sys.stderr)


if __name__ == "__main__":
    main()
