//! A layered layout from left to right: layers by longest path, order by barycentres, heights by least squares.
//! (K. Sugiyama, S. Tagawa, M. Toda, IEEE Transactions on Systems, Man, and Cybernetics 11(2), 1981.)

use super::graph::{Graph, Kind};

/// Space between layers.
const LAYER_GAP: f64 = 44.0;
/// Space between the nodes of a layer.
const NODE_GAP: f64 = 16.0;

/// Where everything stands.
pub(super) struct Layout {
    /// The centre of each node.
    pub(super) at: Vec<(f64, f64)>,
    /// Per node and input: the horizontal stretches (from x, to x, y) that the edge passes on its way.
    pub(super) ways: Vec<Vec<Vec<(f64, f64, f64)>>>,
    pub(super) width: f64,
    pub(super) height: f64,
}

/// A node, or a place where a long edge passes through a layer.
struct Item {
    layer: usize,
    height: f64,
    before: Vec<usize>,
    after: Vec<usize>,
    y: f64,
    /// Whether a long edge passes here.
    passing: bool,
}

/// Places nodes of the given sizes (width, height).
pub(super) fn place(graph: &Graph, sizes: &[(f64, f64)]) -> Layout {
    let layers = layers(graph);
    let item = |layer, height, passing| Item { layer, height, before: Vec::new(), after: Vec::new(), y: 0.0, passing };
    let mut items: Vec<Item> = layers.iter().zip(sizes).map(|(&layer, size)| item(layer, size.1, false)).collect();
    let mut passes: Vec<Vec<Vec<usize>>> = Vec::new();
    for (to, node) in graph.nodes.iter().enumerate() {
        let mut of_node = Vec::new();
        for edge in &node.inputs {
            let mut previous = edge.from;
            let mut of_edge = Vec::new();
            for layer in layers[edge.from] + 1..layers[to] {
                items.push(item(layer, 6.0, true));
                let next = items.len() - 1;
                link(&mut items, previous, next);
                of_edge.push(next);
                previous = next;
            }
            link(&mut items, previous, to);
            of_node.push(of_edge);
        }
        passes.push(of_node);
    }
    let count = layers.iter().max().map_or(0, |last| last + 1);
    let mut order: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (i, item) in items.iter().enumerate() {
        order[item.layer].push(i);
    }
    reorder(&items, &mut order);
    settle(&mut items, &order);

    let widest =
        |layer: &Vec<usize>| layer.iter().filter_map(|&i| sizes.get(i)).fold(0.0, |w: f64, size| w.max(size.0));
    let mut spans = Vec::new();
    let mut x = 0.0;
    for layer in &order {
        let width = widest(layer);
        spans.push((x, x + width));
        x += width + LAYER_GAP;
    }
    let top = items.iter().fold(f64::INFINITY, |top, item| top.min(item.y - item.height / 2.0));
    let bottom = items.iter().fold(f64::NEG_INFINITY, |bottom, item| bottom.max(item.y + item.height / 2.0));
    let centre = |i: usize, item: &Item| {
        let (from, to) = spans[item.layer];
        // Inputs stand flush right, so that their arrows start together.
        let x = if item.layer == 0 { to - sizes[i].0 / 2.0 } else { f64::midpoint(from, to) };
        (x, item.y - top)
    };
    let at = (0..sizes.len()).map(|i| centre(i, &items[i])).collect();
    let stretch = |&i: &usize| (spans[items[i].layer].0, spans[items[i].layer].1, items[i].y - top);
    let ways = passes
        .iter()
        .map(|of_node| of_node.iter().map(|of_edge| of_edge.iter().map(stretch).collect()).collect())
        .collect();
    Layout { at, ways, width: (x - LAYER_GAP).max(0.0), height: (bottom - top).max(0.0) }
}

fn link(items: &mut [Item], from: usize, to: usize) {
    items[from].after.push(to);
    items[to].before.push(from);
}

/// Inputs stand in the first layer, outputs in the last, constants just before their use, operations after the last of
/// what they read.
fn layers(graph: &Graph) -> Vec<usize> {
    let mut layers = vec![0_usize; graph.nodes.len()];
    for (i, node) in graph.nodes.iter().enumerate() {
        layers[i] = node.inputs.iter().map(|edge| layers[edge.from] + 1).max().unwrap_or(0);
    }
    let last = layers.iter().copied().max().unwrap_or(0);
    for (i, node) in graph.nodes.iter().enumerate() {
        if node.kind == Kind::Output {
            layers[i] = last;
        }
        for edge in &node.inputs {
            if graph.nodes[edge.from].kind == Kind::Constant {
                layers[edge.from] = layers[i].saturating_sub(1);
            }
        }
    }
    layers
}

/// Sweeps to and fro, sorting each layer by the mean place of its neighbours; keeps the order with the fewest crossings.
fn reorder(items: &[Item], order: &mut Vec<Vec<usize>>) {
    let mut best = (crossings(items, order), order.clone());
    for sweep in 0..24 {
        let forward = sweep % 2 == 0;
        let mut place = vec![0.0; items.len()];
        let count = order.len();
        for step in 0..count {
            let layer = if forward { step } else { count - 1 - step };
            let key = |i: usize| {
                let neighbours = if forward { &items[i].before } else { &items[i].after };
                let sum: f64 = neighbours.iter().map(|&n| place[n]).sum();
                (!neighbours.is_empty()).then(|| sum / neighbours.len() as f64)
            };
            let mut keyed: Vec<(f64, usize)> =
                order[layer].iter().enumerate().map(|(k, &i)| (key(i).unwrap_or(k as f64), i)).collect();
            keyed.sort_by(|a, b| a.0.total_cmp(&b.0));
            order[layer] = keyed.iter().map(|&(_, i)| i).collect();
            for (k, &i) in order[layer].iter().enumerate() {
                place[i] = k as f64;
            }
        }
        let crossed = crossings(items, order);
        if crossed < best.0 {
            best = (crossed, order.clone());
        }
    }
    *order = best.1;
}

fn crossings(items: &[Item], order: &[Vec<usize>]) -> usize {
    let mut place = vec![0; items.len()];
    for layer in order {
        for (k, &i) in layer.iter().enumerate() {
            place[i] = k;
        }
    }
    let mut crossed = 0;
    for layer in order {
        let links: Vec<(usize, usize)> = layer
            .iter()
            .flat_map(|&i| items[i].after.iter().map(move |&j| (i, j)))
            .map(|(i, j)| (place[i], place[j]))
            .collect();
        for (k, a) in links.iter().enumerate() {
            crossed += links[k + 1..].iter().filter(|b| (a.0 < b.0 && a.1 > b.1) || (a.0 > b.0 && a.1 < b.1)).count();
        }
    }
    crossed
}

/// Moves every node towards the mean height of its neighbours, layer by layer, keeping order and distances.
fn settle(items: &mut [Item], order: &[Vec<usize>]) {
    for layer in order {
        let mut y = 0.0;
        for &i in layer {
            items[i].y = y + items[i].height / 2.0;
            y += items[i].height + NODE_GAP;
        }
        for &i in layer {
            items[i].y -= y / 2.0;
        }
    }
    for sweep in 0..80 {
        for step in 0..order.len() {
            let layer = &order[if sweep % 2 == 0 { step } else { order.len() - 1 - step }];
            let wanted: Vec<(f64, f64)> = layer.iter().map(|&i| wanted(items, i)).collect();
            let gaps: Vec<f64> = layer
                .windows(2)
                .map(|pair| f64::midpoint(items[pair[0]].height, items[pair[1]].height) + NODE_GAP)
                .collect();
            for (&i, y) in layer.iter().zip(closest(&wanted, &gaps)) {
                items[i].y = y;
            }
        }
    }
}

/// Where an item wants to stand, and how much it matters: long edges pull to be straight.
fn wanted(items: &[Item], i: usize) -> (f64, f64) {
    let weight = |n: usize| match (items[i].passing, items[n].passing) {
        (true, true) => 8.0,
        (true, false) | (false, true) => 2.0,
        (false, false) => 1.0,
    };
    let near = items[i].before.iter().chain(&items[i].after);
    let (sum, total) = near.fold((0.0, 0.0), |(sum, total), &n| (sum + weight(n) * items[n].y, total + weight(n)));
    if total > 0.0 { (sum / total, total) } else { (items[i].y, 1.0) }
}

/// The places nearest to what is wanted (place, weight) in weighted least squares, with at least `gaps` between
/// neighbours: pool adjacent violators.
fn closest(wanted: &[(f64, f64)], gaps: &[f64]) -> Vec<f64> {
    let mut offset = 0.0;
    let mut offsets = Vec::new();
    // Weighted sum, weight and size of each pool.
    let mut pools: Vec<(f64, f64, usize)> = Vec::new();
    for (k, &(want, weight)) in wanted.iter().enumerate() {
        if k > 0 {
            offset += gaps[k - 1];
        }
        offsets.push(offset);
        let mut pool = ((want - offset) * weight, weight, 1);
        while let Some(&(sum, weight, count)) = pools.last() {
            if sum / weight <= pool.0 / pool.1 {
                break;
            }
            pool = (sum + pool.0, weight + pool.1, count + pool.2);
            pools.pop();
        }
        pools.push(pool);
    }
    let means = pools.iter().flat_map(|&(sum, weight, count)| std::iter::repeat_n(sum / weight, count));
    means.zip(offsets).map(|(mean, offset)| mean + offset).collect()
}
