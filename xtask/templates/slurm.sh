#!/usr/bin/env bash
#SBATCH --job-name=fisura
#SBATCH --array=1-4
#SBATCH --cpus-per-task=2
#SBATCH --time=02:00:00
#SBATCH --output=%x-%A-%a.log
#
# A job array of slices; submit it, and the merge after it, from the root of the workspace:
#
#   cargo build --release -p xtask
#   array=$(sbatch --parsable xtask/templates/slurm.sh --tier full)
#   sbatch --dependency=afterany:$array --wrap 'cargo xtask merge target/fisura/array/part-* --out target/fisura/array/merged'
#
# Run on one node with Slurm 22.05 from Debian's packages (slurm-wlm), where /etc/slurm/slurm.conf names the controller and
#
#   SelectType=select/cons_tres
#   SelectTypeParameters=CR_CPU
#   NodeName=<host> CPUs=2 State=UNKNOWN
#   PartitionName=main Nodes=<host> Default=YES MaxTime=INFINITE State=UP
#
# A slice with a failed check ends with 1, one with a case that broke down with 3; both are merged all the same, and the merge
# gives the verdict.
set -euo pipefail
status=0
${FISURA:-cargo xtask} verify --partition "slice:$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" \
    --out "target/fisura/array/part-$SLURM_ARRAY_TASK_ID" --threads "${SLURM_CPUS_PER_TASK:-1}" --quiet "$@" || status=$?
case $status in 0 | 1 | 3) ;; *) exit "$status" ;; esac
