"""A ladder in BondGraphTools; run by its own Python: ``bondgraphtools.py rc 10``."""

import json
import sys
import time

import BondGraphTools as bgt


def relations(kind: str, storages: int) -> list:
    """Build the ladder and return its equations, each zero: a rate and the states it hangs on."""
    model = bgt.new(name="ladder")

    def part(component: str, name: str, value: float | None = None):
        made = bgt.new(component, name=name, value=value)
        bgt.add(model, made)
        return made

    before = part("Se", "source", 1)
    for cell in range(storages if kind == "rc" else storages // 2):
        loop, node = part("1", f"loop{cell}"), part("0", f"node{cell}")
        bgt.connect(before, loop)
        bgt.connect(loop, part("R", f"r{cell}", 2))
        if kind == "rlc":
            bgt.connect(loop, part("I", f"l{cell}", 5))
        bgt.connect(loop, node)
        bgt.connect(node, part("C", f"c{cell}", 3))
        before = node
    return model.constitutive_relations


if __name__ == "__main__":
    start = time.process_time()
    found = relations(sys.argv[1], int(sys.argv[2]))
    print(json.dumps({"seconds": time.process_time() - start, "states": len(found)}))
