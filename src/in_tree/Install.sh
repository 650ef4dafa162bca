# Install/unInstall package files in LAMMPS
# mode = 0/1/2 for uninstall/install/update

mode=$1

# enforce using portable C locale
LC_ALL=C
export LC_ALL

# arg1 = file; headers of law/ keep their folder, since they are included as "law/hinge.h"

action () {
  if (test $mode = 0) then
    rm -f ../$1
  elif (! cmp -s $1 ../$1) then
    cp $1 ../$1
    if (test $mode = 2) then
      echo "  updating src/$1"
    fi
  fi
}

if (test $mode != 0) then
  mkdir -p ../law
fi

for file in *.cpp *.h law/*.h; do
  test -f ${file} && action ${file}
done

if (test $mode = 0) then
  test -d ../law && rmdir ../law
fi

# edit 2 Makefile.package files to include/exclude package info

if (test -e ../Makefile.package) then
  sed -i -e 's/[^ \t]*dcm_SYS[^ \t]* //' ../Makefile.package
fi

if (test -e ../Makefile.package.settings) then
  sed -i -e '/^[ \t]*include.*lib\/dcm\/.*$/d' ../Makefile.package.settings
fi

if (test $mode != 0) then

  if (test -e ../Makefile.package) then
    sed -i -e 's|^PKG_SYSINC =[ \t]*|&$(dcm_SYSINC) |' ../Makefile.package
    sed -i -e 's|^PKG_SYSLIB =[ \t]*|&$(dcm_SYSLIB) |' ../Makefile.package
    sed -i -e 's|^PKG_SYSPATH =[ \t]*|&$(dcm_SYSPATH) |' ../Makefile.package
  fi

  if (test -e ../Makefile.package.settings) then
    # multiline form needed for BSD sed on Macs
    sed -i -e '4 i \
include ..\/..\/lib\/dcm\/Makefile.lammps
' ../Makefile.package.settings
  fi

fi
