; The installer for Windows: for the user alone, so that no administrator is asked. Called with OUT, STAGED and VERSION.
Unicode true
Name "NIMA Console"
OutFile "${OUT}"
InstallDir "$LOCALAPPDATA\Programs\NIMA Console"
RequestExecutionLevel user
SetCompressor /SOLID lzma
; The same installer from the same files, whenever it is made.
SetDateSave off
!define UNINSTALL "Software\Microsoft\Windows\CurrentVersion\Uninstall\NIMA Console"

Page directory
Page instfiles
UninstPage uninstConfirm
UninstPage instfiles

Section
  SetOutPath "$INSTDIR"
  File "${STAGED}/nima.exe"
  File "${STAGED}/README.md"
  File "${STAGED}/LICENSE-MIT.txt"
  File "${STAGED}/LICENSE-APACHE.txt"
  File "${STAGED}/third-party.txt"
  File "${STAGED}/sbom.cdx.json"
  WriteUninstaller "$INSTDIR\uninstall.exe"
  CreateShortcut "$SMPROGRAMS\NIMA Console.lnk" "$INSTDIR\nima.exe"
  WriteRegStr HKCU "${UNINSTALL}" "DisplayName" "NIMA Console"
  WriteRegStr HKCU "${UNINSTALL}" "DisplayVersion" "${VERSION}"
  WriteRegStr HKCU "${UNINSTALL}" "UninstallString" '"$INSTDIR\uninstall.exe"'
SectionEnd

Section "Uninstall"
  Delete "$INSTDIR\nima.exe"
  Delete "$INSTDIR\README.md"
  Delete "$INSTDIR\LICENSE-MIT.txt"
  Delete "$INSTDIR\LICENSE-APACHE.txt"
  Delete "$INSTDIR\third-party.txt"
  Delete "$INSTDIR\sbom.cdx.json"
  Delete "$INSTDIR\uninstall.exe"
  RMDir "$INSTDIR"
  Delete "$SMPROGRAMS\NIMA Console.lnk"
  DeleteRegKey HKCU "${UNINSTALL}"
SectionEnd
