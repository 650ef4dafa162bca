# Shared by the commands in tools: install what is missing, build LAMMPS once per
# version into the user's cache folder, build the plugin, prepare the Python environment.
# Every function can be called any number of times and does nothing when its work is done.

DCM_ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
DCM_CACHE=${XDG_CACHE_HOME:-$HOME/.cache}/lammps-dcm
# a preset of CMakePresets.json; without one, the build that tools/run and tools/test share
DCM_PRESET=${DCM_PRESET:-}
# integers of LAMMPS, SMALLBIG or BIGBIG; the latter has builds of its own
LAMMPS_SIZES=${LAMMPS_SIZES:-SMALLBIG}
SIZES_SUFFIX=$([ "$LAMMPS_SIZES" = SMALLBIG ] || echo "-${LAMMPS_SIZES,,}")
DCM_BUILD=${DCM_BUILD_DIR:-$DCM_ROOT/build${DCM_PRESET:+-$DCM_PRESET}$SIZES_SUFFIX}
DCM_JOBS=${DCM_JOBS:-$(nproc)}

LAMMPS_PACKAGE=lammps
LAMMPS_DEBIAN_VERSION=20250204+dfsg.1-2
LAMMPS_SUITE=trixie
LAMMPS_ARCHIVE_SHA256=3671165bd52fad36734e0a9136c5bc5ecb225e03988f8c89aa13366a8b53b1c7
# one letter per change of the build options below, so that an old cache is not reused
LAMMPS_BUILD_TAG=20250204-a
LAMMPS_HOME=$DCM_CACHE/lammps-$LAMMPS_BUILD_TAG
LAMMPS_BUILD=$LAMMPS_HOME/build$SIZES_SUFFIX

say() { printf '[dcm %s] %s\n' "$(date +%H:%M:%S)" "$*"; }
die() { printf '[dcm] ERROR: %s\n' "$*" >&2; exit 1; }

# version of the package, and the commit where there is one
package_version() {
  local version
  version=$(sed -n 's/^#define DCM_VERSION "\(.*\)"/\1/p' "$DCM_ROOT/src/DCM/dcm_version.h")
  printf '%s' "$version"
  git -C "$DCM_ROOT" log -1 --format=' (commit %h)' 2>/dev/null || true
}

# --- packages -----------------------------------------------------------------------------------

# command or file that shows a package is there : Debian package
DCM_PACKAGES=(
  "command:g++:g++" "command:cmake:cmake" "command:make:make" "command:mpicxx:libopenmpi-dev"
  "command:mpirun:openmpi-bin" "command:xz:xz-utils" "command:flock:util-linux"
  "command:git:git"
  "file:/usr/include/eigen3/Eigen/Core:libeigen3-dev" "file:/usr/include/gtest/gtest.h:libgtest-dev"
  "file:/usr/include/png.h:libpng-dev" "python:venv:python3-venv"
)

missing_packages() {
  local entry kind what package
  for entry in "${DCM_PACKAGES[@]}"; do
    IFS=: read -r kind what package <<<"$entry"
    case $kind in
      command) command -v "$what" >/dev/null || echo "$package" ;;
      file) [ -e "$what" ] || echo "$package" ;;
      python) python3 -c 'import venv, ensurepip' 2>/dev/null || echo "$package" ;;
    esac
  done
}

ensure_packages() {
  local missing
  missing=$(missing_packages | sort -u | tr '\n' ' ')
  [ -n "$missing" ] || return 0
  if [ "$(id -u)" -ne 0 ]; then
    die "these Debian packages are missing: $missing
      ask an administrator to run: apt-get install $missing"
  fi
  say "installing Debian packages: $missing"
  export DEBIAN_FRONTEND=noninteractive
  apt-get update -qq || die "apt-get update failed: is the network there?"
  # shellcheck disable=SC2086
  apt-get install -y -qq --no-install-recommends $missing >/dev/null ||
    die "apt-get install $missing failed"
}

# --- LAMMPS -------------------------------------------------------------------------------------

# The source archive comes from Debian itself through a private sources list, so that neither the
# machine's own lists nor its installed packages change, and an ordinary user can do it.
download_lammps() {
  local archive=$1 apt=$LAMMPS_HOME/apt mirror line uri
  if [ -f "$archive" ] && echo "$LAMMPS_ARCHIVE_SHA256  $archive" | sha256sum -c --quiet 2>/dev/null
  then
    return 0
  fi
  mirror=$(apt-get indextargets --format '$(REPO_URI)' 2>/dev/null | grep -v security | sort -u |
    head -n 1)
  [ -n "$mirror" ] ||
    die "apt knows no mirror; run apt-get update, or pass your own LAMMPS to cmake"
  mkdir -p "$apt/lists/partial" "$apt/cache/archives/partial"
  printf 'deb-src %s %s main\n' "$mirror" "$LAMMPS_SUITE" >"$apt/sources.list"
  : >"$apt/status"
  local options=(-o Dir::Etc::SourceList="$apt/sources.list" -o Dir::Etc::SourceParts=/dev/null
    -o Dir::State::Lists="$apt/lists" -o Dir::Cache="$apt/cache" -o Dir::State::status="$apt/status"
    -o APT::Sandbox::User=root -o Debug::NoLocking=1)
  say "looking up the LAMMPS source archive"
  apt-get "${options[@]}" update -qq || die "cannot read Debian's source index ($LAMMPS_SUITE)"
  line=$(apt-get "${options[@]}" source --print-uris --download-only \
    "$LAMMPS_PACKAGE=$LAMMPS_DEBIAN_VERSION" | grep -F .orig.tar) ||
    die "Debian's $LAMMPS_SUITE has no $LAMMPS_PACKAGE=$LAMMPS_DEBIAN_VERSION any more"
  uri=$(cut -d"'" -f2 <<<"$line")
  say "downloading the LAMMPS source archive (132 MB)"
  rm -f "$archive" "$archive.part"
  /usr/lib/apt/apt-helper "${options[@]}" download-file "$uri" "$archive.part" \
    "SHA256:$LAMMPS_ARCHIVE_SHA256" >/dev/null || die "the LAMMPS archive did not arrive whole"
  mv "$archive.part" "$archive"
}

unpack_lammps() {
  local archive=$1
  [ -d "$LAMMPS_HOME/source" ] && return 0
  say "unpacking LAMMPS"
  rm -rf "$LAMMPS_HOME/unpack"
  mkdir -p "$LAMMPS_HOME/unpack"
  tar -xf "$archive" -C "$LAMMPS_HOME/unpack" --strip-components=1 || die "cannot unpack $archive"
  mv "$LAMMPS_HOME/unpack" "$LAMMPS_HOME/source"
}

build_lammps() {
  local log=$LAMMPS_BUILD.log
  say "building LAMMPS (once; 3 to 6 minutes on 2 cores); log: $log"
  {
    cmake -S "$LAMMPS_HOME/source/cmake" -B "$LAMMPS_BUILD" -D LAMMPS_SIZES="${LAMMPS_SIZES,,}" \
      -D CMAKE_BUILD_TYPE=Release -D CMAKE_CXX_FLAGS_RELEASE="-O2 -DNDEBUG" \
      -D BUILD_SHARED_LIBS=yes -D BUILD_MPI=yes -D BUILD_OMP=no -D BUILD_TOOLS=no \
      -D PKG_PLUGIN=yes -D PKG_MOLECULE=yes -D PKG_GRANULAR=yes \
      -D WITH_PNG=yes -D WITH_JPEG=no -D WITH_GZIP=no -D WITH_FFMPEG=no -D WITH_CURL=no \
      -D LAMMPS_EXCEPTIONS=yes &&
      cmake --build "$LAMMPS_BUILD" --parallel "$DCM_JOBS"
  } >"$log" 2>&1 &
  local pid=$! last="" now
  while kill -0 $pid 2>/dev/null; do
    sleep 2
    now=$(grep -oE '^\[ *[0-9]+%\]' "$log" 2>/dev/null | tail -n 1 |
      tr -dc 0-9 || true)
    if [ -n "$now" ] && [ "${now%?}" != "${last%?}" ]; then say "  LAMMPS $now %"; last=$now; fi
  done
  wait $pid || { tail -n 20 "$log" >&2; die "LAMMPS did not build"; }
}

ensure_lammps() {
  if [ -n "${LAMMPS_SOURCE_DIR:-}" ]; then
    [ -f "$LAMMPS_SOURCE_DIR/version.h" ] ||
      die "LAMMPS_SOURCE_DIR=$LAMMPS_SOURCE_DIR is not LAMMPS' src folder (no version.h)"
    [ -n "${LAMMPS_LMP:-}" ] || die "LAMMPS_SOURCE_DIR is set: set LAMMPS_LMP to its lmp as well"
    DCM_LMP=$LAMMPS_LMP
    return 0
  fi
  mkdir -p "$LAMMPS_HOME"
  exec 9>"$LAMMPS_HOME/lock"
  if ! flock -n 9; then
    say "another process is setting up LAMMPS; waiting for it"
    flock 9
  fi
  if [ ! -f "$LAMMPS_HOME/done$SIZES_SUFFIX" ]; then
    local archive=$LAMMPS_HOME/lammps.orig.tar.xz
    [ -d "$LAMMPS_HOME/source" ] || download_lammps "$archive"
    unpack_lammps "$archive"
    build_lammps
    rm -rf "$LAMMPS_HOME/apt" "$archive"
    touch "$LAMMPS_HOME/done$SIZES_SUFFIX"
  fi
  exec 9>&-
  LAMMPS_SOURCE_DIR=$LAMMPS_HOME/source/src
  DCM_LMP=$LAMMPS_BUILD/lmp
}

# --- building -----------------------------------------------------------------------------------

# configure_build CMAKE_ARGUMENT...: what is built here runs here, hence DCM_NATIVE
configure_build() {
  local log=$DCM_BUILD/configure.log preset=()
  mkdir -p "$DCM_BUILD"
  [ -z "$DCM_PRESET" ] || preset=(--preset "$DCM_PRESET")
  (cd "$DCM_ROOT" && cmake "${preset[@]}" -B "$DCM_BUILD" -D DCM_NATIVE="${DCM_NATIVE:-ON}" \
    -D DCM_WERROR="${DCM_WERROR:-OFF}" "$@") >"$log" 2>&1 ||
    { tail -n 20 "$log" >&2; die "cmake failed; log: $log"; }
}

# build_targets WHAT TARGET...
build_targets() {
  local what=$1 log=$DCM_BUILD/build.log
  shift
  # whether there is something to do shows when the first file is compiled or linked: asked before,
  # make always says yes (--question) or does not know of changed headers yet (--dry-run)
  local work='(Building|Linking) CXX'
  cmake --build "$DCM_BUILD" --parallel "$DCM_JOBS" --target "$@" 2>&1 | tee "$log" |
    { grep -m 1 -qE "$work" && say "building $what; log: $log"; cat >/dev/null; } ||
    { grep -E 'error|Error' "$log" | head -n 20 >&2; die "$what: did not build; log: $log"; }
  grep -qE "$work" "$log" || say "$what: up to date"
  ! grep -q 'warning:' "$log" || say "WARNING: the compiler warned; log: $log"
}

# $1: ON to build the unit tests as well
ensure_plugin() {
  mkdir -p "$DCM_BUILD"
  exec 8>"$DCM_BUILD/lock"
  flock 8
  configure_build -D DCM_PLUGIN=ON -D LAMMPS_SOURCE_DIR="$LAMMPS_SOURCE_DIR" \
    -D LAMMPS_SIZES="$LAMMPS_SIZES" -D DCM_TESTS="${1:-OFF}" \
    -D DCM_EXTRA_DIRS="${DCM_EXTRA_DIRS:-}"
  build_targets "the plugin" all
  exec 8>&-
}

# $@: programs of tests/unit, or dcm_unit_tests for all. They need no LAMMPS: a build folder that
# has the plugin keeps it, a new one gets none.
ensure_unit_tests() {
  local plugin=()
  mkdir -p "$DCM_BUILD"
  exec 8>"$DCM_BUILD/lock"
  flock 8
  [ -f "$DCM_BUILD/CMakeCache.txt" ] || plugin=(-D DCM_PLUGIN=OFF)
  configure_build "${plugin[@]}" -D DCM_TESTS=ON
  build_targets "unit tests" "$@"
  exec 8>&-
}

# --- Python -------------------------------------------------------------------------------------

# a virtual environment in the cache folder, one per content of tools/requirements.txt
ensure_python() {
  local sum venv
  sum=$(cat "$DCM_ROOT/tools/requirements.txt" <(python3 --version) | sha256sum | cut -c1-12)
  venv=$DCM_CACHE/python-$sum
  mkdir -p "$DCM_CACHE"
  exec 7>"$venv.lock"
  flock 7
  if [ ! -f "$venv/done" ]; then
    say "preparing the Python environment (once; MDAnalysis, VTK and others from PyPI)"
    rm -rf "$venv"
    python3 -m venv "$venv" || die "python3 -m venv failed"
    "$venv/bin/python" -m pip install --quiet --disable-pip-version-check \
      -r "$DCM_ROOT/tools/requirements.txt" || die "pip could not install tools/requirements.txt"
    touch "$venv/done"
  fi
  exec 7>&-
  DCM_PYTHON=$venv/bin/python
  export PYTHONPATH=$DCM_ROOT/tools${PYTHONPATH:+:$PYTHONPATH}
}

# --- running ------------------------------------------------------------------------------------

export_run_environment() {
  export DCM_LMP DCM_BUILD
  export LAMMPS_PLUGIN_PATH=$DCM_BUILD
  export LAMMPS_POTENTIALS=$DCM_ROOT/potentials
  export OMP_NUM_THREADS=1
  export OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_hwloc_base_binding_policy=none
  if [ "$DCM_PRESET" = asan ]; then
    # the sanitizer must be loaded before an lmp that was not built with it; MPI leaks by itself,
    # and LAMMPS has an error of its own where memory cannot be had
    local lmp=$DCM_BUILD/lmp
    printf '#!/bin/sh\nLD_PRELOAD=%s ASAN_OPTIONS=%s exec %s "$@"\n' \
      "$("${CXX:-c++}" -print-file-name=libasan.so)" \
      detect_leaks=0:allocator_may_return_null=1 "$DCM_LMP" >"$lmp"
    chmod +x "$lmp"
    DCM_LMP=$lmp
  fi
  if [ "$(id -u)" -eq 0 ]; then
    export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
  fi
}
