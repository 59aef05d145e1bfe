#!/usr/bin/env bash
# What forces from the path change: three shipped paths placed with one engagement for the whole path, and with the forces
# of what the path removes of a block. For each: the figure of either run, the placement of the first with the forces of the
# second (planned anew), and how far the two placements are from each other.
#     experiments/engagement.sh target/release/stead
set -euo pipefail
stead=$(realpath "${1:-stead}")
cd "$(dirname "$0")/.."
root=$PWD
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Columns of a table without forces, which the cut gives.
without_forces() { cut -d, -f1-10 "$1" >"$2"; }

# NAME ROBOT X Y Z RADIAL AXIAL STOCK DIAMETER RPM FEED_PER_TOOTH: a run with one engagement, and one with a stock, which
# takes the feed of the path where it has one.
runs() {
    local name=$1 robot=$2 x=$3 y=$4 z=$5 radial=$6 axial=$7 stock=$8 diameter=$9 rpm=${10} tooth=${11} has_feeds=
    if head -n 1 "$work/$name.csv" | grep -q feed_mm_per_s; then has_feeds=1; fi
    for kind in engagement stock; do
        {
            printf 'robot = "%s/configs/robots/%s.toml"\ntask = "%s.csv"\n' "$root" "$robot" "$name"
            printf '[spindle]\nxyz_mm = [0.0, 0.0, 400.0]\nrotation = [[0.0, -0.70710678, 0.70710678], [1.0, 0.0, 0.0], [0.0, 0.70710678, 0.70710678]]\n'
            printf '[cell]\nx_mm = %s\ny_mm = %s\nz_mm = %s\n' "$x" "$y" "$z"
            printf '[constraints]\nmin_inverse_condition = 0.1\ncharacteristic_length_mm = 682.0\n'
            printf '[criterion]\ndirection = "total"\nforce_uncertainty = 0.1\n'
            printf '[redundancy]\nbeta_step_deg = 5.0\nfeed_mm_per_s = 30.0\nmax_spindle_turn_deg_per_mm = 0.5\n'
            printf '[tool]\ncutter_diameter_mm = %s\nflute_length_mm = 60.0\nteeth = 2\ncentre_cutting = true\nkt_mpa = 800.0\nkr = 0.4\nkte_n_per_mm = 20.0\nkre_n_per_mm = 20.0\n' "$diameter"
            printf '[cut]\nspindle_rpm = %s\n' "$rpm"
            if [ $kind = engagement ] || [ -z "$has_feeds" ]; then printf 'feed_per_tooth_mm = %s\n' "$tooth"; fi
            if [ $kind = stock ]; then
                printf '[stock]\n%s\n' "$stock"
            else
                printf 'milling = "conventional"\nradial_depth_mm = %s\naxial_depth_mm = %s\n' "$radial" "$axial"
            fi
            printf '[output]\nmaps = false\npage = false\n'
        } >"$work/$name-$kind.toml"
    done
}

value() { sed -n "s/^ *\"$2\": *\([-0-9.e]*\),*$/\1/p" "$1" | head -n "${3:-1}" | tail -n 1; }
# A column of the first row of a table.
column() { awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) at = i } NR == 2 { print $at }' "$1"; }

"$stead" import path tasks/pocket.cls --step-mm 10 --out "$work/pocket.csv" >/dev/null
without_forces tasks/raster.csv "$work/raster.csv"
without_forces tasks/five-segments.csv "$work/five-segments.csv"
runs pocket kuka-kr210-r2700 '[1000.0, 1800.0]' '[-500.0, 500.0]' '[500.0, 1100.0]' 20.0 8.0 'box_mm = [320.0, 220.0, 25.0]
xyz_mm = [0.0, 0.0, 12.5]' 20.0 12000.0 0.125
runs raster kuka-kr500 '[900.0, 1700.0]' '[-600.0, 600.0]' '[200.0, 800.0]' 20.0 3.0 'allowance_mm = [15.0, 12.5, 3.0]' 25.0 9000.0 0.1
runs five-segments kuka-kr270-r2700 '[1000.0, 1800.0]' '[-500.0, 500.0]' '[500.0, 1100.0]' 16.0 5.0 'allowance_mm = [8.0, 8.0, 5.0]' 16.0 9000.0 0.1

printf '%-14s %-36s %-36s %s\n' path 'one engagement: x y z yaw, mm' 'forces from the path: x y z yaw, mm' 'first placement with the second forces, mm'
for name in pocket raster five-segments; do
    line=$(printf '%-14s' $name)
    for kind in engagement stock; do
        "$stead" place "$work/$name-$kind.toml" --no-worst --out "$work/$name-$kind" >/dev/null
        table=$work/$name-$kind/placements.csv
        place=$(for key in x_mm y_mm z_mm yaw_deg objective_mm; do column "$table" $key; done | tr '\n' ' ')
        line+=$(printf ' %-36s' "$place")
    done
    read -r x y z yaw <<<"$(for key in x_mm y_mm z_mm yaw_deg; do column "$work/$name-engagement/placements.csv" $key; done | tr '\n' ' ')"
    "$stead" score "$work/$name-stock.toml" --x-mm="$x" --y-mm="$y" --z-mm="$z" --yaw-deg="$yaw" --out "$work/$name-score" >/dev/null
    printf '%s %s\n' "$line" "$(value "$work/$name-score/score.json" objective_mm)"
done
