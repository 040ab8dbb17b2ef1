#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# run_in_qemu.sh [--systemd] WORK COMMAND ARGS...: runs a command as root in a virtual machine that has this machine's files
# (read-only), Debian's kernel and virtual cameras: the kernel's own (vivid) and, where it can be had, one to be fed
# (v4l2loopback). With --systemd this machine's systemd and udev run in it, its files can be written (nothing of that stays),
# and there is no camera to be fed. WORK is a folder for the kernel and the initramfs.
# Needs no root and no KVM. Exit code: the command's, 77 (CTest: skipped) where something needed is missing.
# RUMI_QEMU_ACCEL=kvm is faster where KVM works; RUMI_QEMU_TIMEOUT_S is the limit for all of it,
# RUMI_QEMU_MEMORY_MB its memory, RUMI_QEMU_FLAGS what else QEMU is to know. RUMI_QEMU_ROOT is a folder with the files of
# another Debian, instead of this machine's.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
systemd=false
if [ "$1" = --systemd ]; then
  systemd=true
  shift
fi
work=$1
shift
accel=${RUMI_QEMU_ACCEL:-tcg}
limit_s=${RUMI_QEMU_TIMEOUT_S:-400}
root=${RUMI_QEMU_ROOT:-/}

command="$*"
skip() {
  echo "SKIPPED: $1, so this was NOT run in a virtual machine: $command" >&2
  exit 77
}
PATH=$PATH:/usr/sbin:/sbin
for tool in qemu-system-x86_64 busybox cpio modprobe depmod v4l2-ctl; do
  command -v "$tool" >/dev/null || skip "$tool is missing (scripts/install_dependencies.sh qemu-system-x86 busybox-static cpio kmod v4l-utils)"
done
if $systemd; then
  for program in systemd systemd-udevd; do
    [ -x "$root/lib/systemd/$program" ] || skip "$root/lib/systemd/$program is missing (scripts/install_dependencies.sh systemd udev)"
  done
fi

# Cameras are not in the kernels for clouds and containers: fetched once, and not installed.
fetch_kernel() {
  command -v apt-get >/dev/null || return 1
  package=$(apt-cache depends linux-image-amd64 2>/dev/null | awk '/Depends:/ {print $2; exit}')
  [ -n "$package" ] || return 1
  echo "fetching $package (70 MB)"
  rm -rf "$work/kernel.part"
  mkdir -p "$work/kernel.part"
  (cd "$work/kernel.part" && timeout 300 apt-get download -q "$package" && dpkg-deb -x ./*.deb root && rm -- *.deb) || return 1
  version=$(ls "$work/kernel.part/root/lib/modules")
  depmod -b "$work/kernel.part/root" "$version"
  mv "$work/kernel.part/root" "$work/kernel"
}
mkdir -p "$work"
kernel=""
[ -d "$work/kernel" ] || {
  # A Debian machine has one of its own.
  for modules in /lib/modules/*; do
    version=$(basename "$modules")
    vivid=$(find "$modules" -name 'vivid.ko*' 2>/dev/null | head -n 1)
    if [ -n "$vivid" ] && [ -r "/boot/vmlinuz-$version" ] && [ -f "$modules/modules.dep" ]; then kernel=/; break; fi
  done
  [ -n "$kernel" ] || fetch_kernel || skip "no kernel with the module vivid here, and linux-image-amd64 cannot be downloaded"
}
[ -n "$kernel" ] || {
  kernel=$work/kernel
  version=$(ls "$kernel/lib/modules")
}

# The initramfs: busybox, the modules in the order in which they are to be loaded, and init.
rm -rf "$work/initramfs"
mkdir -p "$work/initramfs/bin" "$work/initramfs/modules"
cp "$(command -v busybox)" "$work/initramfs/bin/busybox"
cp "$here/init" "$work/initramfs/init"
chmod 755 "$work/initramfs/init"
modules="9pnet_virtio 9p virtio_pci vivid"
memory_mb=${RUMI_QEMU_MEMORY_MB:-1024}
options=""
if $systemd; then
  cp "$here/init_systemd" "$here/command.service" "$work/initramfs/"
  modules="$modules overlay"
  memory_mb=4096
  # Straight to the command's unit, and not to the host's disks.
  options="systemd.unit=command.service systemd.show_status=false fstab=no luks=no systemd.gpt_auto=no"
fi
for module in $modules; do
  modprobe -d "$kernel" -S "$version" --show-depends "$module" 2>/dev/null | awk '/^insmod/ {print $2}'
done | awk '!seen[$0]++' >"$work/modules"
if ! $systemd; then
  if "$here/build_loopback.sh" "$work" "$version"; then
    echo "$work/v4l2loopback-$version.ko" >>"$work/modules"
  else
    echo "SKIPPED: v4l2loopback cannot be had here, so MJPEG was NOT tested against the kernel's V4L2" >&2
  fi
fi
number=100
while read -r file; do
  name=$(basename "${file%%.ko*}")
  case $file in
    *.xz) xz -dc "$file" >"$work/initramfs/modules/$number-$name.ko" ;;
    *) cp "$file" "$work/initramfs/modules/$number-$name.ko" ;;
  esac
  number=$((number + 1))
done <"$work/modules"
{
  echo "export TMPDIR=/run PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin RUMI_IN_NETNS=1"
  printf 'cd "%s"\n' "$PWD"
  for argument in "$@"; do printf '"%s" ' "$argument"; done
  echo
} >"$work/initramfs/command"
(cd "$work/initramfs" && find . | cpio -o -H newc --quiet | gzip -1) >"$work/initramfs.gz"

# One processor: a second one costs TCG as much as it brings.
# no_timer_check: else the kernel panics at once ("IO-APIC + timer doesn't work") where the host is too busy to emulate it.
begin=$(date +%s)
code=0
# shellcheck disable=SC2086 # several flags
timeout "$limit_s" qemu-system-x86_64 -accel "$accel" -cpu max -nodefaults -display none -monitor none -no-reboot \
  -m "$memory_mb" -smp 1 ${RUMI_QEMU_FLAGS:-} -kernel "$kernel/boot/vmlinuz-$version" -initrd "$work/initramfs.gz" \
  -append "console=ttyS0 quiet no_timer_check panic=-1 loglevel=3 $options" -serial stdio \
  -virtfs "local,path=$root,mount_tag=hostroot,security_model=none,readonly=on,multidevs=remap" </dev/null >"$work/console" || code=$?
tr -d '\r' <"$work/console"
echo "the virtual machine ($accel, $version) ran for $(($(date +%s) - begin)) s"
[ "$code" -ne 124 ] || { echo "error: it did not end within $limit_s s" >&2; exit 1; }
result=$(tr -d '\r' <"$work/console" | sed -n 's/^RUMI_EXIT_CODE=//p')
[ -n "$result" ] || { echo "error: it ended without a result (qemu's exit code $code)" >&2; exit 1; }
exit "$result"
