//! From links and joints to the six joints of an arm: the tree, its root, and the chain from base to tip.

use super::read::{Kind, Urdf};
use super::xml::quoted;
use stead_disk::input::InputError;

/// The joints from the base link to the tip link.
#[derive(Debug, Clone)]
pub(super) struct Chain {
    /// Index of the root link.
    pub root: usize,
    /// All joints from the root link to the base link: where the robot stands.
    pub stand: Vec<usize>,
    /// Index of the base link.
    pub base: usize,
    /// Index of the tip link.
    pub tip: usize,
    /// All joints on the way, base first.
    pub path: Vec<usize>,
    /// The six that move.
    pub moving: [usize; 6],
}

/// Who is whose child.
#[derive(Debug)]
pub(super) struct Tree {
    /// The joint that leads to each link: none for the root.
    to: Vec<Option<usize>>,
    /// Links in an order in which every parent comes before its children.
    order: Vec<usize>,
}

const ONE_TREE: &str = "links that form one tree: every link but one is the child of exactly one joint";

impl Tree {
    /// Checks that the links form one tree.
    pub fn new(urdf: &Urdf) -> Result<Self, InputError> {
        let mut to: Vec<Option<usize>> = vec![None; urdf.links.len()];
        let mut below: Vec<Vec<usize>> = vec![Vec::new(); urdf.links.len()];
        for (index, joint) in urdf.joints.iter().enumerate() {
            if let Some(other) = to[joint.child].replace(index) {
                let (child, other) = (quoted(&urdf.links[joint.child].name), quoted(&urdf.joints[other].name));
                return Err(urdf.joint_error(
                    index,
                    format!("leads to link {child}, and so does joint {other}"),
                    ONE_TREE,
                ));
            }
            below[joint.parent].push(joint.child);
        }
        let roots: Vec<usize> = (0..to.len()).filter(|link| to[*link].is_none()).collect();
        let mut order = roots.clone();
        let mut next = 0;
        while let Some(link) = order.get(next).copied() {
            order.extend(&below[link]);
            next += 1;
        }
        if order.len() < to.len() {
            return Err(cycle(urdf, &to, &order));
        }
        if let [first, second, ..] = roots[..] {
            let [first, second] = [first, second].map(|link| &urdf.links[link]);
            let problem = format!("is the child of no joint, and neither is link {}: two roots", quoted(&first.name));
            return Err(urdf.error(second.byte, format!("link {}", quoted(&second.name)), problem, ONE_TREE));
        }
        Ok(Self { to, order })
    }

    /// The root link.
    fn root(&self) -> usize {
        self.order[0]
    }

    /// The joints from a link to one below it, the first first; none where it is not below.
    fn path(&self, urdf: &Urdf, from: usize, to: usize) -> Option<Vec<usize>> {
        let (mut path, mut link) = (Vec::new(), to);
        while link != from {
            let joint = self.to[link]?;
            path.push(joint);
            link = urdf.joints[joint].parent;
        }
        path.reverse();
        Some(path)
    }

    /// For each link at or below another, how many moving joints are between.
    fn moving_below(&self, urdf: &Urdf, base: usize) -> Vec<Option<usize>> {
        let mut counts = vec![None; self.to.len()];
        for link in &self.order {
            let above = self.to[*link].map(|joint| &urdf.joints[joint]);
            let count = above.and_then(|joint| Some(counts[joint.parent]? + usize::from(joint.kind != Kind::Fixed)));
            counts[*link] = if *link == base { Some(0) } else { count };
        }
        counts
    }
}

fn cycle(urdf: &Urdf, to: &[Option<usize>], reached: &[usize]) -> InputError {
    let mut is_reached = vec![false; to.len()];
    reached.iter().for_each(|link| is_reached[*link] = true);
    let joint = (0..to.len()).find(|link| !is_reached[*link]).and_then(|link| to[link]).unwrap_or_default();
    urdf.joint_error(joint, "is in a cycle of links, or hangs on one", ONE_TREE)
}

impl Chain {
    /// The chain between two named links, or else from `base_link` or the root to `tool0`, `flange` or the link behind
    /// the last moving joint.
    pub fn new(urdf: &Urdf, tree: &Tree, base: Option<&str>, tip: Option<&str>) -> Result<Self, InputError> {
        let base = base.map(|name| link_named(urdf, "--base-link", name)).transpose()?;
        let from = base.unwrap_or(tree.root());
        let tip = match tip {
            Some(name) => link_named(urdf, "--tip-link", name)?,
            None => find_tip(urdf, tree, from)?,
        };
        let Some(mut path) = tree.path(urdf, from, tip) else {
            let problem = format!("is not below the base link {}", quoted(&urdf.links[from].name));
            let field = format!("link {}", quoted(&urdf.links[tip].name));
            return Err(urdf.error(urdf.links[tip].byte, field, problem, "--tip-link with a link below --base-link"));
        };
        let mut from = from;
        if base.is_none() {
            // What a file puts before `base_link` says where the robot stands.
            let fixed = path.iter().take_while(|joint| urdf.joints[**joint].kind == Kind::Fixed).count();
            let named = |joint: usize| urdf.links[urdf.joints[joint].child].name.ends_with("base_link");
            if let Some(last) = (0..fixed).find(|k| named(path[*k])) {
                from = urdf.joints[path[last]].child;
                path.drain(..=last);
            }
        }
        let moving: Vec<usize> = path.iter().copied().filter(|joint| urdf.joints[*joint].kind != Kind::Fixed).collect();
        let root = tree.root();
        let stand = tree.path(urdf, root, from).unwrap_or_default();
        Ok(Self { root, stand, base: from, tip, moving: six(urdf, &moving, tip)?, path })
    }

    /// The joint nearest to the base link among those that move and carry it: a rail, another arm.
    pub fn carrier(&self, urdf: &Urdf) -> Option<usize> {
        self.stand.iter().rev().copied().find(|joint| urdf.joints[*joint].kind != Kind::Fixed)
    }

    /// Joints that move and are not in the chain, but no more than hang on the arm: springs, parallel links, grippers.
    pub fn side(&self, urdf: &Urdf) -> Vec<usize> {
        let is_side = |joint: &usize| urdf.joints[*joint].kind != Kind::Fixed && !self.moving.contains(joint);
        (0..urdf.joints.len()).filter(is_side).collect()
    }

    /// The passive joints of a parallelogram that drives axis 3, those that follow joint 3: its crank, on the links
    /// beside axis 2, and its rod, on the forearm. None where they do not close one.
    pub fn linkage(&self, urdf: &Urdf) -> Vec<usize> {
        let [_, second, third, ..] = self.moving.map(|joint| &urdf.joints[joint]);
        let side = self.side(urdf).into_iter();
        let all: Vec<usize> = side.filter(|joint| urdf.joints[*joint].mimic.as_ref() == Some(&third.name)).collect();
        let hangs_on = |links: &[usize]| all.iter().any(|joint| links.contains(&urdf.joints[*joint].parent));
        let is_closed = hangs_on(&[second.parent, second.child, third.parent]) && hangs_on(&[third.child]);
        if is_closed { all } else { Vec::new() }
    }
}

fn link_named(urdf: &Urdf, option: &str, name: &str) -> Result<usize, InputError> {
    let found = urdf.links.iter().position(|link| link.name == name);
    found.ok_or_else(|| {
        let near = urdf.links.iter().max_by(|a, b| strsim::jaro(&a.name, name).total_cmp(&strsim::jaro(&b.name, name)));
        let near = near.map(|link| quoted(&link.name)).unwrap_or_default();
        let error = InputError::new(&urdf.file, "names no link of the file").in_field(option);
        error.found(quoted(name)).allowed(format!("the name of a <link>; the nearest one is {near}"))
    })
}

/// The link that the tool is at, where it is not named.
fn find_tip(urdf: &Urdf, tree: &Tree, base: usize) -> Result<usize, InputError> {
    let counts = tree.moving_below(urdf, base);
    for name in ["tool0", "flange"] {
        let at_six = |link: &usize| counts[*link] == Some(6) && urdf.links[*link].name.ends_with(name);
        let found: Vec<usize> = (0..counts.len()).filter(at_six).collect();
        match found[..] {
            [tip] => return Ok(tip),
            [first, second, ..] => return Err(two_tips(urdf, first, second)),
            [] => {}
        }
    }
    let most = counts.iter().flatten().max().copied().unwrap_or_default();
    let is_last = |link: &usize| {
        let moves = tree.to[*link].is_some_and(|joint| urdf.joints[joint].kind != Kind::Fixed);
        counts[*link] == Some(most) && (moves || *link == base)
    };
    let last: Vec<usize> = (0..counts.len()).filter(is_last).collect();
    match last[..] {
        [first, second, ..] => Err(two_tips(urdf, first, second)),
        [tip] => Ok(tip),
        [] => Ok(base),
    }
}

fn two_tips(urdf: &Urdf, first: usize, second: usize) -> InputError {
    let [first, second] = [first, second].map(|link| &urdf.links[link]);
    let problem = format!("may be the end of the arm, and so may link {}", quoted(&first.name));
    let allowed = "--tip-link with the name of the flange";
    urdf.error(second.byte, format!("link {}", quoted(&second.name)), problem, allowed)
}

/// The six joints of an arm: refuses more, fewer, or others than hinges.
fn six(urdf: &Urdf, moving: &[usize], tip: usize) -> Result<[usize; 6], InputError> {
    const HINGES: &str =
        "six revolute or continuous joints; --base-link and --tip-link choose the part of a longer chain";
    for joint in moving {
        if let Kind::Other(kind) = urdf.joints[*joint].kind {
            return Err(urdf.joint_error(*joint, format!("is a {kind} joint in the chain of the arm"), HINGES));
        }
        if let Some(other) = &urdf.joints[*joint].mimic {
            let problem = format!("follows joint {} and is in the chain of the arm", quoted(other));
            return Err(urdf.joint_error(*joint, problem, "six joints that move by themselves"));
        }
    }
    <[usize; 6]>::try_from(moving).map_err(|_| {
        let names: Vec<&str> = moving.iter().take(12).map(|joint| urdf.joints[*joint].name.as_str()).collect();
        let field = format!("link {}", quoted(&urdf.links[tip].name));
        let problem = format!("is behind {} moving joints", moving.len());
        urdf.error(urdf.links[tip].byte, field, problem, HINGES).found(quoted(&names.join(", ")))
    })
}
