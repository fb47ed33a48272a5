"""Places of multipliers and block RAM on an ECP5, found before nextpnr places the rest:

    SEED=1 nextpnr-ecp5 --pre-place blocks.py --seed 1 ...

nextpnr takes these blocks to a free site in one step, wherever that is, and everything else follows them: four lanes of
standard24 then have twice the wire that they need. Here every other cell is thought to lie where its nets pull it. Two
blocks pull at each other in proportion to how often a walk along nets that begins at the one meets the other first (in
a circuit of resistors, the conductance that is left between two terminals). Simulated annealing exchanges sites until
the sum of pulls times distances hardly falls. `ctx` is nextpnr's."""

import math
import os
import random

KINDS = ("MULT18X18D", "DP16KD")
CELLS_OF_NET = 40  # Nets of more cells say nothing about places.
WALKS = 4_000  # From each block.
STEPS = 10_000  # Of a walk at most.
LEAST = 1 / 2_000  # Of the pulls at either block together: weaker ones are left out.
EXCHANGES = 6_000  # That are tried for each block.


def nets_of(cells):
    """Nets as lists of their cells' numbers."""
    number = {name: place for place, name in enumerate(cells)}
    nets = []
    for _, net in ctx.nets:
        ends = [net.driver.cell, *(user.cell for user in net.users)]
        own = sorted({number[end.name] for end in ends if end})
        if 2 <= len(own) <= CELLS_OF_NET:
            nets.append(own)
    return nets


def pulls_between(cells, blocks, draw):
    """For each block, the others that pull at it and how much."""
    nets = nets_of(cells)
    of_cell = [[] for _ in cells]
    for net in nets:
        for cell in net:
            of_cell[cell].append(net)
    block_of = {cell: block for block, cell in enumerate(blocks)}
    pulls = [{} for _ in blocks]
    for block, start in enumerate(blocks):
        for _ in range(WALKS if of_cell[start] else 0):
            cell, pull = start, len(of_cell[start]) / WALKS
            for _ in range(STEPS):
                net = of_cell[cell][int(draw() * len(of_cell[cell]))]
                # Another of its cells.
                following = net[int(draw() * (len(net) - 1))]
                cell = net[-1] if following == cell else following
                met = block_of.get(cell)
                if met is not None:
                    if met != block:
                        pulls[block][met] = pulls[block].get(met, 0) + pull
                        pulls[met][block] = pulls[met].get(block, 0) + pull
                    break
    least = [LEAST * sum(own.values()) for own in pulls]
    return [
        [(other, pull) for other, pull in own.items() if pull > min(least[block], least[other])]
        for block, own in enumerate(pulls)
    ]


def annealed(kinds, pulls, sites, draw):
    """The site of each block, of those of its kind."""
    free = {kind: iter(own) for kind, own in sites.items()}
    at = [next(free[kind]) for kind in kinds]
    owner = {site: block for block, site in enumerate(at)}

    def cost(block, site, but):
        x, y, _ = site
        return sum(pull * (abs(x - at[o][0]) + abs(y - at[o][1])) for o, pull in pulls[block] if o != but)

    whole = sum(cost(block, site, None) for block, site in enumerate(at))
    tries = EXCHANGES * len(at)
    for turn in range(tries):
        warmth = whole / len(at) / 4 * (1 - turn / tries) ** 3
        block = int(draw() * len(at))
        own = sites[kinds[block]]
        was, site = at[block], own[int(draw() * len(own))]
        other = owner.get(site)
        if other == block:
            continue
        change = cost(block, site, other) - cost(block, was, other)
        if other is not None:
            change += cost(other, was, block) - cost(other, site, block)
        if change < 0 or draw() < math.exp(-change / warmth):
            at[block], owner[site] = site, block
            owner.pop(was)
            if other is not None:
                at[other], owner[was] = was, other
    return at


def main():
    draw = random.Random(int(os.environ.get("SEED", "1"))).random
    cells = {name: cell.type for name, cell in ctx.cells}
    blocks = [place for place, kind in enumerate(cells.values()) if kind in KINDS]
    names = list(cells)
    kinds = [cells[names[block]] for block in blocks]
    sites = {kind: [] for kind in KINDS}
    for bel in ctx.getBels():
        if ctx.getBelType(bel) in sites:
            place = ctx.getBelLocation(bel)
            sites[ctx.getBelType(bel)].append((place.x, place.y, bel))
    for kind, own in sites.items():
        if kinds.count(kind) > len(own):
            raise ValueError(f"{kinds.count(kind)} of {kind}, but the device has {len(own)}")
    placed = annealed(kinds, pulls_between(cells, blocks, draw), sites, draw)
    for block, (_, _, bel) in zip(blocks, placed):
        ctx.cells[names[block]].setAttr("BEL", bel)


main()
