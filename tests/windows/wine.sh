# Sets what programs for Windows run with here: to be sourced, with a folder for what Wine lacks. Leaves the command in `wine`, empty
# where there is none.
wine=$(command -v wine64 || ls /usr/lib/wine/wine64 2>/dev/null) || wine=
export WINEDEBUG=${WINEDEBUG--all}
# Wine 8 has no bcryptprimitives.dll, which Windows 10 has: a stand-in, for tests alone.
if command -v x86_64-w64-mingw32-gcc >/dev/null; then
    x86_64-w64-mingw32-gcc -shared -o "$1/bcryptprimitives.dll" "$(dirname "${BASH_SOURCE[0]}")/process_prng.c" -ladvapi32
    absolute=$(realpath "$1")
    export WINEPATH="Z:${absolute//\//\\}"
fi
