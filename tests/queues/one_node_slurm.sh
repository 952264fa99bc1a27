#!/bin/bash
# A Slurm of one node, from Debian's packages and without systemd, for tests:
#     one_node_slurm.sh start FOLDER      as root; installs slurm-wlm and munge where they are not
#     one_node_slurm.sh stop FOLDER       ends only what `start` has started
# Jobs share the cores of this machine, four at a time. SLURM_CONF is FOLDER/slurm.conf.
set -eu
action=$1
mkdir -p "$2"
folder=$(realpath "$2")
export SLURM_CONF="$folder/slurm.conf"

stop() {
    for name in slurmd slurmctld munged; do
        [ -s "$folder/$name.pid" ] && kill "$(cat "$folder/$name.pid")" 2>/dev/null || true
    done
}

start() {
    if ! command -v slurmctld >/dev/null || ! command -v munged >/dev/null; then
        apt-get update -qq
        DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends slurm-wlm munge
    fi
    mkdir -p "$folder/state" "$folder/spool"
    # a socket of its own: nothing of another munge is touched
    chown munge "$folder"
    chmod 755 "$folder"
    runuser -u munge -- /usr/sbin/munged --force --socket="$folder/munge.socket" \
        --pid-file="$folder/munged.pid" --log-file="$folder/munged.log" --seed-file="$folder/munge.seed"
    cat >"$SLURM_CONF" <<END
ClusterName=one
SlurmctldHost=$(hostname)(127.0.0.1)
SlurmctldPort=${SLURM_TEST_PORT:-17817}
SlurmdPort=$((${SLURM_TEST_PORT:-17817} + 1))
AuthType=auth/munge
# a job that is requeued waits twice this time: 240 s, if nothing is said
AuthInfo=socket=$folder/munge.socket,cred_expire=5
SlurmUser=root
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdParameters=config_overrides
ReturnToService=2
JobRequeue=1
KillWait=30
MinJobAge=3600
NodeName=$(hostname) NodeAddr=127.0.0.1 CPUs=4 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END
    slurmctld
    slurmd -N "$(hostname)"
    for _ in $(seq 60); do
        sinfo --noheader --format=%t 2>/dev/null | grep -q idle && exit 0
        sleep 1
    done
    tail -n 20 "$folder"/slurm*.log >&2
    stop
    exit 1
}

"$action"
