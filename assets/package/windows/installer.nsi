; The installer for Windows, for one user: no administrator is needed. Made by assets/package/windows.sh, which gives VERSION, FILES and OUT.
Target amd64-unicode
SetCompressor /SOLID lzma
SetDateSave off
RequestExecutionLevel user
Name "NIMA Console ${VERSION}"
OutFile "${OUT}"
Icon "${FILES}/nima-console.ico"
UninstallIcon "${FILES}/nima-console.ico"
InstallDir "$LOCALAPPDATA\Programs\NIMA Console"

!define KEY "Software\Microsoft\Windows\CurrentVersion\Uninstall\NIMA Console"

Page directory
Page instfiles
UninstPage uninstConfirm
UninstPage instfiles

Section
  SetOutPath "$INSTDIR"
  File "${FILES}/*"
  WriteUninstaller "$INSTDIR\uninstall.exe"
  CreateShortcut "$SMPROGRAMS\NIMA Console.lnk" "$INSTDIR\nima.exe" "console" "$INSTDIR\nima-console.ico"
  WriteRegStr HKCU "${KEY}" "DisplayName" "NIMA Console"
  WriteRegStr HKCU "${KEY}" "DisplayVersion" "${VERSION}"
  WriteRegStr HKCU "${KEY}" "DisplayIcon" "$INSTDIR\nima-console.ico"
  WriteRegStr HKCU "${KEY}" "UninstallString" '"$INSTDIR\uninstall.exe"'
  WriteRegStr HKCU "${KEY}" "QuietUninstallString" '"$INSTDIR\uninstall.exe" /S'
  WriteRegDWORD HKCU "${KEY}" "NoModify" 1
  WriteRegDWORD HKCU "${KEY}" "NoRepair" 1
SectionEnd

; Only what the installer brought: sessions lie elsewhere, and are the user's.
Section "Uninstall"
  Delete "$INSTDIR\nima.exe"
  Delete "$INSTDIR\nima-console.ico"
  Delete "$INSTDIR\README.md"
  Delete "$INSTDIR\CHANGELOG.md"
  Delete "$INSTDIR\LICENSE-MIT"
  Delete "$INSTDIR\LICENSE-APACHE"
  Delete "$INSTDIR\third-party.txt"
  Delete "$INSTDIR\sbom.cdx.json"
  Delete "$INSTDIR\uninstall.exe"
  RMDir "$INSTDIR"
  Delete "$SMPROGRAMS\NIMA Console.lnk"
  DeleteRegKey HKCU "${KEY}"
SectionEnd
