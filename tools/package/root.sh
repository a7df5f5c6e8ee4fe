#!/bin/bash
# Roots of releases of Debian and Ubuntu, made by debootstrap from the mirror of this machine's apt. Sourced by
# tools/test_in_release and test_installed. Exit status 77, with the reason: such a root cannot be made here.
# shellcheck disable=SC2016 # commands for a root are in single quotes: its own shell expands them

skip()
{
    echo "skipped: $*"
    exit 77
}

say()
{
    echo "$0: $*" >&2
}

# The mirror that this machine takes its own packages from.
mirror_of_machine()
{
    local origin=Debian
    [[ $1 != noble ]] || origin=Ubuntu
    apt-get indextargets --format '$(ORIGIN) $(LABEL) $(REPO_URI)' 'Created-By: Packages' 2> /dev/null |
        awk -v origin="$origin" '$1 == origin && $2 == origin { print $3; exit }'
}

# How this machine's apt reaches its mirror (proxy, time-outs, checks of dates), whom it trusts, and names of hosts.
copy_settings()
{
    local root=$1
    apt-config dump | grep '^Acquire::' > "$root/etc/apt/apt.conf.d/90machine" || true
    cp -L /etc/resolv.conf /etc/hosts "$root/etc/"
    if compgen -G '/usr/local/share/ca-certificates/*.crt' > /dev/null; then
        mkdir -p "$root/usr/local/share/ca-certificates"
        cp -L /usr/local/share/ca-certificates/*.crt "$root/usr/local/share/ca-certificates/"
    fi
}

# Makes the root of a release in a folder, unless it is there and complete; its log is ROOT.log.
make_root()
{
    local release=$1 root=$2 mirror program
    ((EUID == 0)) || skip "this is not root, who alone can make a root of a release"
    for program in debootstrap unshare apt-get; do
        command -v "$program" > /dev/null || skip "$program is not installed"
    done
    if [[ ! -e $root.complete ]]; then
        mirror=$(mirror_of_machine "$release")
        [[ -n $mirror ]] || skip "apt of this machine names no mirror that has $release"
        say "debootstrapping $release (log: $root.log)"
        rm -rf "$root"
        mkdir -p "$(dirname "$root")"
        debootstrap --variant=minbase --include=ca-certificates "$release" "$root" "$mirror" > "$root.log" 2>&1 ||
            skip "debootstrap failed: $(grep -E '^[EW]:' "$root.log" | tail -n 1)"
        copy_settings "$root"
        chroot "$root" sh -c 'update-ca-certificates && apt-get -q update' >> "$root.log" 2>&1
        touch "$root.complete"
    fi
    run_in_root "$root" true || skip "mounts are not allowed here"
}

# run_in_root ROOT COMMAND [FOLDER:PLACE...] runs a command in a root, with folders of this machine at places in it.
# With CHANGES=FOLDER the root stays as it is: all changes go into that folder. Mounts and processes end with it.
run_in_root()
{
    local root=$1 command=$2 name
    shift 2
    local -a environment=(HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive)
    for name in http_proxy https_proxy no_proxy TERM; do
        [[ -z ${!name:-} ]] || environment+=("$name=${!name}")
    done
    unshare --mount --pid --fork --kill-child --propagation private bash -c '
        set -e
        root=$1 command=$2 changes=$3 count=$4
        shift 4
        if [[ -n $changes ]]; then
            mkdir -p "$changes"/{upper,work,root}
            mount -t overlay overlay -o "lowerdir=$root,upperdir=$changes/upper,workdir=$changes/work" "$changes/root"
            root=$changes/root
        fi
        for pair in "${@:1:count}"; do
            mkdir -p "$root${pair##*:}"
            mount --bind "${pair%:*}" "$root${pair##*:}"
        done
        shift "$count"
        mount -t proc proc "$root/proc"
        mount --rbind /dev "$root/dev"
        mount -t tmpfs -o mode=1777 tmpfs "$root/tmp"
        exec chroot "$root" env -i "$@" bash -c "$command"
    ' run_in_root "$root" "$command" "${CHANGES:-}" "$#" "$@" "${environment[@]}"
}
