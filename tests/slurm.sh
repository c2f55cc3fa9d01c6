#!/bin/sh
# slurm.sh - the recipe of src/cli/README.md, "On a farm", on a Slurm of one node on this machine: an array job of chunks,
# of which one task stops with status 75 and one is killed, both are put back into the queue, and a merge
# follows.
#
#     sh tests/slurm.sh build/lightcuts
#
# Slurm runs as the user, on loopback, without munge, database and control groups: for tests only. All is
# skipped where it is not installed or does not start.
set -u
. "$(dirname "$0")/support/harness.sh"
[ $# -eq 1 ] || { echo "usage: sh tests/slurm.sh BINARY" >&2; exit 2; }
stopped='task 2 stopped with 75 and was put back'
killed='task 3 was killed and put back'
merged='the merge found all chunks'
same='the bytes of one run'
give_up() # why
{
    for name in "$stopped" "$killed" "$merged" "$same"; do skip "$name" "$1"; done
    finish
    exit 0
}
for program in /usr/sbin/slurmctld /usr/sbin/slurmd; do [ -x $program ] || give_up "no $program"; done
for program in sbatch squeue scontrol sinfo; do has $program || give_up "no $program"; done
daemons=
at_end()
{
    # shellcheck disable=SC2086
    [ -z "$daemons" ] || kill $daemons 2>/dev/null
    wait 2>/dev/null
}
begin "$1"

# ---- a cluster of this machine ----

host=$(hostname -s)
port=$((20000 + $$ % 20000))
mkdir state spool
cat >slurm.conf <<END
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
AuthType=auth/none
CredType=cred/none
StateSaveLocation=$T/state
SlurmdSpoolDir=$T/spool
SlurmctldPidFile=$T/slurmctld.pid
SlurmdPidFile=$T/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
KillWait=5
RequeueExit=75,137
SchedulerParameters=batch_sched_delay=0,sched_interval=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=render Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
: >plugstack.conf
SLURM_CONF=$T/slurm.conf
export SLURM_CONF
until_true() # tenths of a second, command...
{
    tenths=$1
    shift
    while [ "$tenths" -gt 0 ]; do
        "$@" >/dev/null 2>&1 && return 0
        sleep 0.2
        tenths=$((tenths - 2))
    done
    return 1
}
up() { scontrol ping | grep -q 'is UP'; }
idle() { sinfo -h -o %T | grep -q '^idle'; }
/usr/sbin/slurmctld -D -i >slurmctld.log 2>&1 &
daemons=$!
until_true 300 up || give_up "slurmctld does not start: $(tail -n 1 slurmctld.log)"
/usr/sbin/slurmd -D >slurmd.log 2>&1 &
daemons="$daemons $!"
until_true 300 idle || give_up "slurmd does not start: $(tail -n 1 slurmd.log)"

# ---- the job ----

mkdir job
cd job || exit 2
"$L" scene cornell --lights 300 -o scene.pbrt
"$L" -q scene.pbrt --spp 4 -o single.exr
# The first attempt of task 2 has hardly any time; that of task 3 is killed by the line before it. No `exec`:
# a killed program that has replaced its script counts as a failed launch, which is not put back.
cat >tile.sbatch <<END
#!/bin/sh
#SBATCH --array=1-4 --requeue --cpus-per-task=1 --open-mode=append --output=%a.log
limit=1h
[ "\$SLURM_ARRAY_TASK_ID\${SLURM_RESTART_COUNT:-0}" != 20 ] || limit=0.01
if [ "\$SLURM_ARRAY_TASK_ID" = 3 ] && mkdir was-killed 2>/dev/null; then
    { while [ ! -s tile-3.ckpt ]; do sleep 0.02; done; sleep 0.1; kill -9 "\$(cat pid)"; } &
    '$L' -q -t 1 --spp 4 --chunk slurm --checkpoint tile-3.ckpt --resume -o tile-3.exr scene.pbrt &
    echo \$! >pid
    wait \$!
else
    '$L' -q -t "\$SLURM_CPUS_PER_TASK" --spp 4 --chunk "\${CHUNK:-slurm}" --resume --time-limit \$limit \\
        --checkpoint "tile-\$SLURM_ARRAY_TASK_ID.ckpt" -o "tile-\$SLURM_ARRAY_TASK_ID.exr" scene.pbrt
fi
status=\$?
echo "status \$status"
exit \$status
END
cat >merge.sbatch <<END
#!/bin/sh
#SBATCH --output=merge.log
'$L' merge -o full.exr tile-*.exr
END
# With afterok Slurm would drop the merge as soon as a task ends with 75, although the task is put back.
submit() # options
{
    job=$(sbatch --parsable "$@" tile.sbatch)
    merge=$(sbatch --parsable --dependency=afterany:"$job" merge.sbatch)
}
finished()
{
    # A task that was put back would wait for two minutes.
    squeue -h -r -t PD -j "$job" -o %i |
        while read -r task; do scontrol update jobid="$task" StartTime=now; done
    [ -z "$(squeue -h -j "$job,$merge" -o %i)" ]
}
submit
until_true 1500 finished || cat ../slurmctld.log
# Slurm has been seen to drop a task whose program was killed, one time in a hundred: what the merge missed is
# rendered as README says.
if [ ! -s tile-3.exr ]; then
    grep 'missing chunk: 3' merge.log
    submit --array=3 --export=ALL,CHUNK=3/4
    until_true 1500 finished || cat ../slurmctld.log
fi

check "$stopped" test "$(sed -n 's/^status //p' 2.log | tr '\n' ' ')" = '75 0 '
check "$killed" test "$(sed -n 's/^status //p' 3.log | tr '\n' ' ')" = '137 0 '
check "$merged" test -s full.exr
check "$same" cmp full.exr single.exr
[ "$failed" -eq 0 ] || tail -n 5 ./*.log
finish
