#!/bin/bash
# A study on a real Slurm cluster of this machine alone: 20 elements of an array, one of them requeued in mid-run, end with the bytes
# that one process writes. `study.sh STEAD`, with the binary to test. Needs what one-node.sh needs.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
stead=$(realpath "$1")
work=$(mktemp -d)
finish() {
    "$here/one-node.sh" stop "$work/cluster"
    # The daemons write their last state while they end.
    for _ in $(seq 100); do
        if rm -rf "$work" 2>/dev/null; then return; fi
        sleep 0.1
    done
}
trap finish EXIT

cat > "$work/study.toml" <<END
base = "$here/../../configs/caro-2013.toml"

[[axis]]
field = "robot.joints[1].stiffness_mnm_per_rad"
range = { from = 0.2, to = 6.0, count = 20, spacing = "log" }

[[axis]]
name = "search"
fields = ["search.population", "search.generations", "search.basins", "redundancy.beta_step_deg"]
values = [[24, 4, 1, 7.2]]
labels = ["small"]
END
cd "$work"
"$stead" study run study.toml --out alone
"$stead" study slurm study.toml --shards 20 --out array > array.sh

"$here/one-node.sh" start "$work/cluster"
export SLURM_CONF="$work/cluster/slurm.conf"
job=$(sbatch --parsable --output="$work/element-%a.log" array.sh)
# An element is requeued while it runs.
for _ in $(seq 200); do
    element=$(squeue --noheader --states=running --format=%K | head -n 1)
    if [ -n "$element" ]; then break; fi
    sleep 0.05
done
scontrol requeue "${job}_$element"
for _ in $(seq 600); do
    if [ -z "$(squeue --noheader)" ]; then break; fi
    sleep 0.5
done
requeued=$(scontrol show job "${job}_$element" | sed -n 's/.*Restarts=\([0-9]*\).*/\1/p' | head -n 1)
if [ "${requeued:-0}" -lt 1 ]; then
    echo "study.sh: element $element was not requeued" >&2
    exit 1
fi
if ! cmp alone/study.csv array/study.csv; then
    tail -n 5 element-*.log >&2
    exit 1
fi
"$stead" study status study.toml --out array | head -n 1
echo "slurm: 20 elements, element $element requeued: the same bytes as one process"
